#include "common/learning/products.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "common/inference/tones.hpp"
#include "common/learning/terms.hpp"

namespace fathom::learning {
namespace {

using likelihood::Factor;
using likelihood::Feature;
using likelihood::Quantity;

constexpr double kMomentLasts = 0.3;     // s
constexpr double kFewestPeriods = 3.0;   // of a swing within the recordings: less is drift
constexpr double kMomentFromEnd = 0.05;  // of the recording: nearer to its ends nothing has a before

class Library {
 public:
  Library(const likelihood::Problem& problem, const inference::Seen& seen, const model::Scene& scene, Clock clock)
      : problem_{problem}, seen_{seen}, scene_{scene}, clock_{clock}, terms_{terms_of(problem, seen, scene)} {
    for (std::size_t r = 0; r < problem.runs.size(); ++r) adjoint_.push_back(adjoint(problem, seen.reference[r], r));
  }

  likelihood::FreeForce make() {
    const std::vector<Modulator> modulators = modulators_of(problem_, scene_);
    const std::vector<double> moments = sharpest();
    for (std::size_t k = 0; k < terms_.size(); ++k) {
      const Term& term = terms_[k];
      if (!term.held) multiply(term, {.columns = {{}}}, term.searched);
      for (const Modulator& modulator : modulators) {
        if (!allows(modulator)) continue;
        if ((modulator.of & term.kind) != 0) multiply(term, modulator, modulator.searched);
      }
      if (term.kind == kPlainTerm) continue;
      const Factor step{.quantity = Quantity::kAfter, .a = moments[k], .b = kMomentLasts};
      multiply(term, {.words = ", from a moment on", .columns = {{step}}}, true);
    }
    if (scene_.attitude && clock_ != Clock::kLasting) swings(modulators);
    scale();
    force_.weights.assign(force_.features.size(), 0.0);
    return std::move(force_);
  }

 private:
  [[nodiscard]] bool allows(const Modulator& modulator) const {
    return !modulator.of_recording || clock_ == Clock::kTables;
  }

  /// Every column of a term times every column of what modulates it: one group.
  void multiply(const Term& term, const Modulator& modulator, bool searched = false) {
    likelihood::FeatureGroup group{.kind = term.words + modulator.words,
                                   .axis = term.axis,
                                   .first = static_cast<int>(force_.features.size()),
                                   .searched = searched,
                                   .closed = term.closed && modulator.closed};
    for (const std::vector<Factor>& own : term.columns) {
      for (const std::vector<Factor>& by : modulator.columns) {
        Feature feature{.axis = term.axis, .count = static_cast<int>(own.size() + by.size())};
        std::ranges::copy(by, std::ranges::copy(own, feature.factors.begin()).out);
        force_.features.push_back(feature);
        ++group.count;
      }
    }
    force_.groups.push_back(std::move(group));
  }

  /// For every term that can begin at a moment, the one from which on the likelihood's slope with it, summed, is
  /// largest against what such a sum is by chance (cumulated sums; Page 1954).
  [[nodiscard]] std::vector<double> sharpest() const {
    struct Slope {
      double t{}, slope{}, square{};
    };
    std::vector<std::vector<Slope>> slopes(terms_.size());
    std::vector<likelihood::Feature> features;
    for (const Term& term : terms_) {
      Feature feature{.axis = term.axis, .count = static_cast<int>(term.columns.back().size())};
      std::ranges::copy(term.columns.back(), feature.factors.begin());
      features.push_back(feature);
    }
    each_block([&](std::size_t r, std::size_t b, const likelihood::FeatureState& state, const Matrix6d& inverse) {
      for (std::size_t k = 0; k < terms_.size(); ++k) {
        if (terms_[k].kind == kPlainTerm) continue;
        Vector6d wrench = Vector6d::Zero();
        features[k].add(state, 1.0, wrench);
        const Vector6d nu_dot = inverse * wrench;
        Slope slope{.t = state.t};
        for (int i = 0; i < problem_.simulated; ++i) {
          const double a = nu_dot[problem_.axes[static_cast<std::size_t>(i)]];
          slope.slope += a * adjoint_[r](i, static_cast<Eigen::Index>(b));
          slope.square += a * a;
        }
        slopes[k].push_back(slope);
      }
    });
    std::vector<double> moments(terms_.size(), problem_.t_low);
    const double margin = kMomentFromEnd * (problem_.t_high - problem_.t_low);
    for (std::size_t k = 0; k < terms_.size(); ++k) {
      std::ranges::sort(slopes[k], std::greater{}, &Slope::t);
      double whole = 0.0, of_all = 0.0, square = 0.0, sum = 0.0, most = -1.0;
      for (const Slope& slope : slopes[k]) whole += slope.square, of_all += slope.slope;
      for (const Slope& slope : slopes[k]) {
        square += slope.square;
        sum += slope.slope;
        if (slope.t < problem_.t_low + margin || slope.t > problem_.t_high - margin || whole <= 0.0) continue;
        const double share = square / whole;
        if (share <= 0.0 || share >= 1.0) continue;
        const double off = (sum - share * of_all) * (sum - share * of_all) / (share * (1.0 - share));
        if (off > most) most = off, moments[k] = slope.t;
      }
    }
    return moments;
  }

  /// A force that swings, and water that swings, which carries the craft and is felt by all that feels a stream. What
  /// modulates a stream modulates such water: a wave's phase goes with the place, its size with the depth.
  void swings(const std::vector<Modulator>& modulators) {
    const double lowest = kFewestPeriods * 2.0 * std::numbers::pi / std::max(problem_.t_high - problem_.t_low, 1.0);
    for (int w = 0; w < 3; ++w) {
      if (std::ranges::find(problem_.axes.begin(), problem_.axes.begin() + problem_.simulated, w) ==
          problem_.axes.begin() + problem_.simulated)
        continue;
      const int axis = likelihood::kWorldAxis + w;
      const std::string toward = model::direction_words(axis);
      for (const double omega : inference::strongest_tones(problem_, adjoint_, w, lowest)) {
        const auto pair = [&](Quantity cosine, Quantity sine) {
          return Columns{{{.quantity = cosine, .a = omega, .b = 0.0, .c = 0.0}},
                         {{.quantity = sine, .a = omega, .b = 0.0, .c = 0.0}}};
        };
        const Term force{.words = "a swing toward " + toward,
                         .axis = axis,
                         .columns = pair(Quantity::kToneCosine, Quantity::kToneSine)},
            water{.words = "a swing of the water toward " + toward,
                  .axis = model::kStream + w,
                  .columns = pair(Quantity::kTravelCosine, Quantity::kTravelSine)};
        multiply(force, {.columns = {{}}}, true);
        multiply(water, {.columns = {{}}}, true);
        for (const Modulator& modulator : modulators) {
          if (allows(modulator) && !modulator.searched && (modulator.of & kStreamTerm) != 0)
            multiply(water, modulator, true);
        }
      }
    }
  }

  /// Root mean square of each feature becomes that of the applied wrench along it.
  void scale() {
    Eigen::VectorXd square = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(force_.features.size()));
    double count = 0.0, thrust = 0.0;
    Vector6d drag = Vector6d::Zero(), tau = Vector6d::Zero();
    each_block([&](std::size_t, std::size_t, const likelihood::FeatureState& state, const Matrix6d&) {
      for (std::size_t j = 0; j < force_.features.size(); ++j) {
        const double size = force_.features[j].size(state);
        square[static_cast<Eigen::Index>(j)] += size * size;
      }
      drag += state.drag.cwiseAbs2();
      tau += state.tau.cwiseAbs2();
      thrust += state.force.squaredNorm();
      count += 1.0;
    });
    // Along the whole drag or thrust a feature is a share of it.
    const double of_drag = std::sqrt(tau.head<3>().sum() / std::max(drag.head<3>().sum(), 1e-12));
    for (std::size_t j = 0; j < force_.features.size(); ++j) {
      Feature& feature = force_.features[j];
      const double rms = std::sqrt(square[static_cast<Eigen::Index>(j)] / std::max(count, 1.0));
      double wrench = scene_.tau_rms.head<3>().norm();
      if (feature.axis < likelihood::kWorldAxis) wrench = scene_.tau_rms[feature.axis];
      if (feature.of_drag()) wrench = of_drag;
      if (feature.axis == model::kAllThrust) wrench = 1.0;
      if (feature.axis == model::kEachThruster) wrench = std::sqrt(thrust / std::max(count, 1.0));
      if (feature.levers()) wrench = scene_.tau_rms.segment<2>(3).norm();
      feature.scale = rms > 0.0 ? std::max(wrench, 1e-6) / rms : 0.0;
      if (feature.axis == model::kEachAxis) feature.scale = 1.0;  // shares of the thrust
    }
  }

  template <typename Use>
  void each_block(const Use& use) const {
    const std::vector<likelihood::Number> none;
    for (std::size_t r = 0; r < problem_.runs.size(); ++r) {
      likelihood::Plant plant{seen_.fit.hypothesis, none, problem_.runs[r], r, false};
      plant.begin(problem_.runs[r].start());
      for (std::size_t b = 0; b < problem_.runs[r].blocks().size(); ++b) {
        const auto at = static_cast<Eigen::Index>(b);
        plant.at_middle(b);
        use(r, b, plant.features_at(seen_.reference[r].nu_middle.col(at), true),
            Matrix6d{seen_.inverse[r].col(at).reshaped(6, 6)});
        plant.end_block(b, seen_.reference[r].nu_end.col(at));
      }
    }
  }

  const likelihood::Problem& problem_;
  const inference::Seen& seen_;
  const model::Scene& scene_;
  Clock clock_;
  std::vector<Term> terms_;
  std::vector<Eigen::MatrixXd> adjoint_;
  likelihood::FreeForce force_;
};

}  // namespace

likelihood::FreeForce products_of(const likelihood::Problem& problem, const inference::Seen& seen,
                                  const model::Scene& scene, Clock clock) {
  return Library{problem, seen, scene, clock}.make();
}

}  // namespace fathom::learning
