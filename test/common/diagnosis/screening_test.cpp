// The quick first look: what the base parameters can imitate is taken out, the true cause gains most, and nothing gains
// on a clean dive.
#include "common/diagnosis/screening.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "test/support/virtual_dive.hpp"

using namespace fathom;
using namespace fathom::diagnosis;

namespace {

constexpr double kUnit = 1e-9;  // rounding of a norm over some thousand residuals
constexpr double kFirstOrder =
    0.15;                         // of the number: screening leaves the base parameters where they are, to 1st order
constexpr double kNoise = 0.005;  // share of the cost that one of some fifty candidates may fit by chance in 90 s

/// A fitted dive of a four-axis vehicle, ready to be asked.
struct Fitted {
  explicit Fitted(std::vector<model::ActiveEffect> effects)
      : dive{test::make_dive(vehicle, {.duration = 90.0, .seed = 21, .effects = std::move(effects)})},
        problem{vehicle, {&dive.trial, 1}, {}},
        fit{problem.fit(model::nominal_model(vehicle, false))},
        base{problem, fit},
        scene{model::scene_of(vehicle, {&dive.trial, 1})} {}

  [[nodiscard]] double cost() const {
    double sum = 0.0;
    for (const double cost : base.window_cost()) sum += cost;
    return sum;
  }
  /// The best form of each effect.
  [[nodiscard]] std::vector<Screened> ask_all() const {
    std::vector<Screened> all;
    for (const model::Effect* effect : model::all_effects()) {
      const auto names = effect->variants(scene);
      std::optional<Screened> best;
      for (std::size_t v = 0; v < names.size(); ++v) {
        if (names[v] == "-") continue;
        Screened one = screen(base, *effect, static_cast<int>(v), names[v], effect->starts(scene, static_cast<int>(v)));
        if (!best || one.gain > best->gain) best = std::move(one);
      }
      if (best) all.push_back(std::move(*best));
    }
    return all;
  }

  model::Vehicle vehicle = test::vehicle_from_repository("seabotix_lbv150");
  test::VirtualDive dive;
  identification::TrajectoryFit problem;
  identification::FitResult fit;
  Linearisation base;
  model::Scene scene;
};

}  // namespace

TEST_CASE("screening: what is left has nothing that a step of the base parameters could take") {
  const Fitted fitted{{test::active("current", {0.1, -0.05})}};
  const auto windows = fitted.base.windows();
  Eigen::VectorXd before = Eigen::VectorXd::Zero(windows[0].jacobian.cols()), after = before, size = before;
  Eigen::Index offset = 0;
  for (const auto& window : windows) {
    const auto rows = window.jacobian.rows();
    after += window.jacobian.transpose() * fitted.base.unexplained().col(0).segment(offset, rows);
    size += window.jacobian.colwise().squaredNorm().transpose();
    offset += rows;
  }
  // Cosine between each column and the residual; only the priors (weak) may leave some.
  constexpr double kPriors = 0.01;
  const double norm = fitted.base.unexplained().norm();
  for (Eigen::Index j = 0; j < after.size(); ++j)
    CHECK(std::abs(after[j]) < kPriors * norm * std::sqrt(size[j]) + 1e-9);
  CHECK(offset == fitted.base.stacked_residual().size());
}

TEST_CASE("screening: the cause that is there gains most, near its true size") {
  const Fitted fitted{{test::active("thrust_asymmetry", {-0.25})}};
  const std::vector<Screened> asked = fitted.ask_all();
  const Screened* best = &asked.front();
  for (const Screened& one : asked) {
    CAPTURE(one.effect->name());
    CHECK(one.gain >= 0.0);
    CHECK(one.gain <= fitted.cost());
    CHECK(one.window_cost.size() == fitted.base.window_cost().size());
    if (one.gain > 0.0) CHECK(one.signature.norm() == doctest::Approx(1.0).epsilon(kUnit));
    if (one.gain > best->gain) best = &one;
  }
  CHECK(best->effect->name() == "thrust_asymmetry");
  CHECK(best->theta[0] == doctest::Approx(-0.25).epsilon(kFirstOrder));
  double with = 0.0;
  for (const double cost : best->window_cost) with += cost;
  CHECK(with == doctest::Approx(fitted.cost() - best->gain));
}

TEST_CASE("screening: on a clean dive nobody gains") {
  const Fitted fitted{{}};
  for (const Screened& one : fitted.ask_all()) {
    CAPTURE(one.effect->name());
    CAPTURE(one.variant_name);
    CHECK(one.gain < kNoise * fitted.cost() * static_cast<double>(one.theta.size()));
  }
}

TEST_CASE("screening: the found numbers respect physical bounds") {
  // A vehicle that answers early looks like negative lag: physics stops at none.
  const Fitted fitted{{test::active("thrust_overshoot", {0.5, 0.8})}};
  for (const Screened& one : fitted.ask_all()) {
    const auto parameters = one.effect->parameters();
    CAPTURE(one.effect->name());
    for (std::size_t i = 0; i < parameters.size(); ++i) {
      CHECK(one.theta[i] >= parameters[i].low);
      CHECK(one.theta[i] <= parameters[i].high);
    }
  }
}

TEST_CASE("screening: an amplitude may have either sign, wherever the search begins") {
  for (const double sign : {1.0, -1.0}) {
    const Fitted fitted{{test::active("payload_change", {0.0, 3.0 * sign, 52.0})}};
    const model::Effect& effect = *model::find_effect("payload_change");
    const Screened found = screen(fitted.base, effect, 0, "", effect.starts(fitted.scene, 0));
    CAPTURE(sign);
    CHECK(found.theta[1] == doctest::Approx(3.0 * sign).epsilon(kFirstOrder));
    constexpr double kMoment = 1.0;  // s: the step itself lasts as long
    CHECK(std::abs(found.theta[2] - 52.0) < kMoment);
  }
}

TEST_CASE("screening: windows for a first look hold those that are explained worst, each once and in order") {
  const Fitted fitted{{test::active("tether_tension", {1.5, 1.0, 1.5, 0.5, 0.0})}};
  const std::size_t count = fitted.base.windows().size();
  REQUIRE(count >= 6);
  const std::size_t most = count / 2;
  const Linearisation first = fitted.base.telling(most);
  CHECK(first.windows().size() <= most);
  CHECK(std::ranges::adjacent_find(first.places(), std::greater_equal<>{}) == first.places().end());
  const auto cost = fitted.base.window_cost();
  const auto worst = std::ranges::max_element(cost) - cost.begin();
  CHECK(std::ranges::find(first.places(), static_cast<std::size_t>(worst)) != first.places().end());
  CHECK(fitted.base.telling(count).windows().size() == count);
}

TEST_CASE("screening: what a first look found is seen by every window as the search itself would see it there") {
  const Fitted fitted{{test::active("current", {0.1, -0.05})}};
  const model::Effect& current = *model::find_effect("current");
  const Linearisation first = fitted.base.thinned(fitted.base.windows().size() / 2);
  const Screened rough = screen(first, current, 0, "", current.starts(fitted.scene, 0));
  const Screened seen = seen_by(fitted.base, rough), refined = refine(fitted.base, rough);
  CHECK(seen.theta == rough.theta);
  CHECK(seen.signature.size() == refined.signature.size());
  CHECK(seen.signature.norm() == doctest::Approx(1.0).epsilon(kUnit));
  CHECK(seen.gain > 0.0);
  CHECK(refined.gain >= seen.gain);
  Screened absent = rough;
  absent.theta.assign(absent.theta.size(), 0.0);
  CHECK(seen_by(fitted.base, absent).gain == 0.0);
}
