// A whole cause takes what lasts in the error with it, whatever the noise; a stand-in leaves its own wrong form behind.
#include "common/diagnosis/left_over.hpp"

#include <doctest/doctest.h>

#include <cmath>

#include "test/support/virtual_dive.hpp"

using namespace fathom;
using namespace fathom::diagnosis;
using identification::FitResult;
using identification::TrajectoryFit;

namespace {

constexpr double kDuration = 150.0;  // s

/// Weed collects: all drag grows with time. No effect of the registry does this.
class GrowingDrag final : public model::Form {
 public:
  void load(const model::Motion& motion, model::EffectTheta theta, model::Load& load) const override {
    const Eigen::Vector3d v = motion.nu.head<3>();
    load.wrench.head<3>() -= theta[0] * motion.t / kDuration * v.cwiseProduct(v.cwiseAbs());
  }
};
struct Weed : model::Effect {
  Weed()
      : Effect{{.name = "weed"}, std::array{model::EffectParameter{"growth", "", 100.0}}, model::forms(GrowingDrag{})} {
  }
};

constexpr double kFilter = 0.1;  // s: an estimator that remembers

/// Share that `suspect` explains on a dive that it was not fitted to, with `hidden` in both.
double share(const model::ActiveEffect& hidden, const model::ActiveEffect& suspect, double noise_memory = 0.0,
             double moment = kWhiteNoise) {
  const model::Vehicle vehicle = test::vehicle_from_repository("seabotix_lbv150");
  const auto dive = [&](unsigned seed) {
    return test::make_dive(
        vehicle,
        {.duration = kDuration, .seed = seed, .noise_memory = noise_memory, .spread = 0.0, .effects = {hidden}});
  };
  const test::VirtualDive first = dive(21), second = dive(22);
  const std::vector<Trial> train{first.trial}, unseen{second.trial};
  const identification::FitSettings settings{.window = 5.0, .threads = 1, .iterations = 10};
  const TrajectoryFit problem{vehicle, train, settings};
  const FitResult without = problem.fit(model::nominal_model(vehicle, false));
  model::Model model = without.model;
  model.add(suspect);
  const FitResult with = problem.fit(model, &without);
  const TrajectoryFit windows{vehicle, unseen, settings};
  return share_explained(lasting_error(windows, without.model, 0.0, moment),
                         lasting_error(windows, with.model, 0.0, moment));
}

LastingError axis(int which, double square, double error, double all) {
  LastingError lasting;
  lasting.square[which] = square;
  lasting.error[which] = error;
  lasting.all[which] = all;
  return lasting;
}

}  // namespace

TEST_CASE("left over: a true cause explains what lasts, a stand-in does not") {
  CHECK(share(test::active("current", {0.08, -0.05}), test::active("current", {0.01, 0.01})) > kWholeCause);
  const Weed weed;
  const model::ActiveEffect hidden{&weed, 0, "", {150.0}};
  CHECK(share(hidden, test::active("battery_sag", {0.5})) < kWholeCause);
}

TEST_CASE("left over: what an estimator has coloured is forgotten within half a second, a stand-in's rest is not") {
  const model::ActiveEffect current = test::active("current", {0.02, -0.01}),
                            guess = test::active("current", {0.01, 0.01});
  CHECK(share(current, guess, kFilter) < kWholeCause);  // .1 s later the noise is still there
  CHECK(share(current, guess, kFilter, kFilteredNoise) > kWholeCause);
  const Weed weed;
  const model::ActiveEffect hidden{&weed, 0, "", {150.0}};
  CHECK(share(hidden, test::active("battery_sag", {0.5}), kFilter, kFilteredNoise) < kWholeCause);
}

TEST_CASE("left over: whether anything lacks is told beside noise of either kind") {
  const model::Vehicle vehicle = test::vehicle_from_repository("seabotix_lbv150");
  const auto lacking = [&](double noise_memory, double moment, std::vector<model::ActiveEffect> effects) {
    const test::VirtualDive dive = test::make_dive(vehicle, {.duration = kDuration,
                                                             .seed = 23,
                                                             .noise_memory = noise_memory,
                                                             .spread = 0.0,
                                                             .effects = std::move(effects)});
    const TrajectoryFit windows{vehicle, {&dive.trial, 1}, {.window = 5.0, .threads = 1}};
    return certainly_lacking(lasting_error(windows, model::nominal_model(vehicle, false), 0.0, moment));
  };
  CHECK_FALSE(lacking(0.0, kWhiteNoise, {}));
  CHECK(lacking(kFilter, kWhiteNoise, {}));
  CHECK_FALSE(lacking(kFilter, kFilteredNoise, {}));
  CHECK(lacking(kFilter, kFilteredNoise, {test::active("current", {0.08, -0.05})}));
}

TEST_CASE("left over: what is not certainly left counts as gone, and axes where nothing is gone do not count") {
  CHECK(share_explained(axis(0, 4.0, 0.1, 5.0), axis(0, 1.0, 0.0, 2.0)) == doctest::Approx(0.75));
  CHECK(share_explained(axis(0, 4.0, 0.1, 5.0), axis(0, 1.0, 0.5, 2.0)) == 1.0);
  LastingError before = axis(0, 4.0, 0.0, 5.0), after = axis(0, 1.0, 0.0, 2.0);
  before.square[5] = after.square[5] = 7.0;
  before.all[5] = after.all[5] = 8.0;
  CHECK(share_explained(before, after) == doctest::Approx(0.75));
  CHECK(share_explained(axis(0, 4.0, 0.1, 5.0), axis(0, 4.5, 0.1, 5.0)) == 0.0);
  CHECK(share_explained(axis(0, 0.1, 0.1, 5.0), axis(0, 0.2, 0.01, 5.0)) == 1.0);
  CHECK(share_explained(LastingError{}, LastingError{}) == 1.0);
}

TEST_CASE("left over: a name is no surer than the share that it stands for") {
  CHECK(at_most_for(1.0, 40.0) == 40.0);
  CHECK(at_most_for(kWholeCause, 40.0) == doctest::Approx(0.0));
  CHECK(at_most_for(0.99, 40.0) == doctest::Approx(std::log(9.0)));
  CHECK(at_most_for(0.99, 1.0) == 1.0);
  CHECK(at_most_for(0.5, 40.0) < std::log(0.1));
  CHECK(std::isfinite(at_most_for(0.0, 40.0)));
}
