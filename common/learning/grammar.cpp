#include "common/learning/grammar.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace fathom::learning {
namespace {

using likelihood::Problem;
using model::Factor;
using model::Feature;
using model::kWorldAxis;
using model::Quantity;

constexpr double kMoves = 1e-3;       // m/s, rad/s: an axis that does less shows nothing
constexpr double kInnerPrice = 2.3;   // nats for a number of unknown order
constexpr double kMomentPrice = 5.3;  // a moment has many places
constexpr double kLinePrice = 9.0;    // a frequency more
constexpr double kMomentLasts = 0.3;  // s
constexpr int kMoments = 30;
constexpr double kMomentRoom = 8.0, kMomentStep = 1.0;  // s about a moment that the learned force has found

/// "tau_Y", "f_north".
std::string symbol_of(int axis) {
  const std::string left = model::direction_symbol(axis);
  return left.substr(0, left.find(' '));
}

Feature along(int axis, std::initializer_list<Factor> factors) {
  Feature feature{.axis = axis, .count = static_cast<int>(factors.size())};
  std::ranges::copy(factors, feature.factors.begin());
  return feature;
}
Factor of(Quantity quantity, int index = 0, double a = 0.0, double b = 1.0) {
  return {.quantity = quantity, .index = index, .a = a, .b = b};
}

}  // namespace

std::string equation_of(const std::vector<Feature>& features, const std::string& moment) {
  std::string sum;
  for (std::size_t k = 0; k < features.size(); ++k) {
    Feature feature = features[k];
    std::string since;
    for (int i = 0; i < feature.count && !moment.empty(); ++i) {
      if (feature.factors[static_cast<std::size_t>(i)].quantity != Quantity::kAfter) continue;
      feature.factors[static_cast<std::size_t>(i)] = feature.factors[static_cast<std::size_t>(feature.count - 1)];
      --feature.count;
      since = " 1(t > " + moment + ")";
    }
    const std::string product = feature.words();
    sum += (k == 0 ? "c" : " + c") + (features.size() > 1 ? "_" + std::to_string(k + 1) : std::string{}) +
           (product.empty() ? "" : " ") + product + since;
  }
  return features.size() > 1 && features.front().axis >= model::kHullDrag ? "(" + sum + ")" : sum;
}

namespace {

class Grammar {
 public:
  Grammar(const Problem& problem, const model::Scene& scene) : problem_{problem}, scene_{scene} {
    const double length = problem.t_high - problem.t_low;
    for (int i = 1; i < kMoments; ++i) moments_.push_back(problem.t_low + length * i / kMoments);
    for (double omega = 0.2; omega < 6.0; omega += 2.0 / std::max(length, 1.0)) lines_.push_back(omega);
  }

  void body(int axis) {
    const auto moving = [&](int j) { return scene_.nu_rms[j] > kMoves; };
    for (int j = 0; j < 6; ++j) {
      if (!moving(j)) continue;
      const std::string v = model::kVelocityNames[static_cast<std::size_t>(j)];
      const std::vector<double> powers = j == axis ? std::vector{3.0, 4.0} : std::vector{1.0, 1.5, 2.0, 2.5, 3.0};
      add(axis, "a power of " + v + ", against or with it", "c sign(" + v + ") |" + v + "|^n", "n", "", powers,
          kInnerPrice, [=](double n) { return std::vector{along(axis, {of(Quantity::kPowerOdd, j, n)})}; });
      add(axis, "a power of " + v + ", whatever its sign", "c |" + v + "|^n", "n", "", {1.0, 1.5, 2.0, 2.5, 3.0},
          kInnerPrice, [=](double n) { return std::vector{along(axis, {of(Quantity::kPowerEven, j, n)})}; });
      for (int k = j + 1; k < 6; ++k) {
        if (!moving(k)) continue;
        const std::string w = model::kVelocityNames[static_cast<std::size_t>(k)];
        add(axis, v + " and " + w + " together", "c " + v + " " + w, [=](double) {
          return std::vector{along(axis, {of(Quantity::kVelocity, j), of(Quantity::kVelocity, k)})};
        });
      }
      for (int k = 0; k < 6; ++k) {
        if (!moving(k) || k == j) continue;
        const std::string w = model::kVelocityNames[static_cast<std::size_t>(k)];
        add(axis, w + ", the more the faster " + v + " is", "c |" + v + "| " + w, [=](double) {
          return std::vector{along(axis, {of(Quantity::kSpeed, j), of(Quantity::kVelocity, k)})};
        });
      }
    }
    const std::string own = model::kVelocityNames[static_cast<std::size_t>(axis)];
    for (int i = 0; i < problem_.simulated; ++i) {
      const int j = problem_.axes[static_cast<std::size_t>(i)];
      const std::string tau = symbol_of(j);
      if (j != axis)
        add(axis, "thrust of another axis", "c " + tau,
            [=](double) { return std::vector{along(axis, {of(Quantity::kWrench, j)})}; });
      add(axis, "the size of a thrust", "c |" + tau + "|",
          [=](double) { return std::vector{along(axis, {of(Quantity::kWrenchSize, j)})}; });
      add(axis, "thrust that weakens with the speed", "c |" + tau + "| " + own, [=](double) {
        return std::vector{along(axis, {of(Quantity::kWrenchSize, j), of(Quantity::kVelocity, axis)})};
      });
    }
    moment(axis, "a moment", "c", {});
    moment(axis, "a thrust that changes at a moment", "c " + symbol_of(axis), {of(Quantity::kWrench, axis)});
    moment(axis, "a drag that changes at a moment", "c |" + own + "| " + own,
           {of(Quantity::kSpeed, axis), of(Quantity::kVelocity, axis)});
  }

  void world(int axis) {
    add(axis, "nothing: it is steady", "c", [=](double) { return std::vector{along(axis, {})}; });
    add(axis, "the speed", "c |v|", [=](double) { return std::vector{along(axis, {of(Quantity::kFlowSpeed)})}; });
    const double low = problem_.t_low, length = std::max(problem_.t_high - problem_.t_low, 1.0);
    add(axis, "time: it creeps", "c (t - t_0) / T",
        [=](double) { return std::vector{along(axis, {of(Quantity::kRamp, 0, low, length)})}; });
    moment(axis, "a moment", "c", {});
    moment(axis, "the speed, from a moment on", "c |v|", {of(Quantity::kFlowSpeed)});
    add(axis, "a swing", "c_1 cos(w t) + c_2 sin(w t)", "w", "rad/s", lines_, kLinePrice, [=](double omega) {
      return std::vector{along(axis, {of(Quantity::kToneCosine, 0, omega)}),
                         along(axis, {of(Quantity::kToneSine, 0, omega)})};
    });
  }

  /// What the learned force holds from a moment on, the moment left open.
  void again(const inference::GroupFound& group, const model::FreeForce& force) {
    for (const model::FeatureGroup& own : force.groups) {
      if (own.kind != group.kind || own.axis != group.axis || !own.closed || !own.searched) continue;
      const std::vector<Feature> features(force.features.begin() + own.first,
                                          force.features.begin() + own.first + own.count);
      const auto is_moment = [](const Factor& factor) { return factor.quantity == Quantity::kAfter; };
      const auto& first = features.front().factors;
      const auto moment = std::find_if(first.begin(), first.begin() + features.front().count, is_moment);
      if (moment == first.begin() + features.front().count) continue;
      std::vector<double> grid;
      for (double t = -kMomentRoom; t <= kMomentRoom; t += kMomentStep) grid.push_back(moment->a + t);
      add(own.axis, own.kind, equation_of(features, "t_1"), "t_1", "s", grid, kMomentPrice, [=](double t) {
        std::vector<Feature> moved = features;
        for (Feature& feature : moved) {
          for (int i = 0; i < feature.count; ++i) {
            if (is_moment(feature.factors[static_cast<std::size_t>(i)]))
              feature.factors[static_cast<std::size_t>(i)].a = t;
          }
        }
        return moved;
      });
    }
  }

  std::vector<Form> forms;

 private:
  void add(int axis, const std::string& words, const std::string& equation, const std::string& symbol,
           const std::string& unit, std::vector<double> grid, double price,
           std::function<std::vector<Feature>(double)> features) {
    forms.push_back({words, model::direction_symbol(axis) + " " + equation, symbol, unit, axis, std::move(grid), price,
                     std::move(features)});
  }
  void add(int axis, const std::string& words, const std::string& equation,
           std::function<std::vector<Feature>(double)> features) {
    add(axis, words, equation, "", "", {0.0}, 0.0, std::move(features));
  }
  void moment(int axis, const std::string& words, const std::string& equation, const std::vector<Factor>& factors) {
    add(axis, words, equation + " from t_1 on", "t_1", "s", moments_, kMomentPrice, [=](double t) {
      Feature feature{.axis = axis, .count = static_cast<int>(factors.size()) + 1};
      std::ranges::copy(factors, feature.factors.begin());
      feature.factors[factors.size()] = of(Quantity::kAfter, 0, t, kMomentLasts);
      return std::vector{feature};
    });
  }

  const Problem& problem_;
  const model::Scene& scene_;
  std::vector<double> moments_, lines_;
};

}  // namespace

std::vector<Form> grammar(const Problem& problem, const model::Scene& scene, const inference::FreeForceFound& found) {
  Grammar grammar{problem, scene};
  std::vector<bool> asked(6, false);
  for (const inference::GroupFound& group : found.groups) {
    if (group.axis < kWorldAxis) asked[static_cast<std::size_t>(group.axis)] = true;
  }
  asked[static_cast<std::size_t>(found.size.axis)] = true;
  for (int i = 0; i < problem.simulated; ++i) {
    const int axis = problem.axes[static_cast<std::size_t>(i)];
    if (asked[static_cast<std::size_t>(axis)]) grammar.body(axis);
    if (scene.attitude && axis < 3) grammar.world(kWorldAxis + axis);
  }
  for (const inference::GroupFound& group : found.groups) grammar.again(group, found.fit.hypothesis.force);
  return std::move(grammar.forms);
}

}  // namespace fathom::learning
