// Base numbers that a fit has bent leave no residual that counts as structure; what is none of theirs stays.
#include "common/diagnosis/bent_base.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <random>

#include "common/diagnosis/moved.hpp"
#include "common/residual/force_residual.hpp"
#include "test/support/virtual_dive.hpp"

using namespace fathom;
using namespace fathom::diagnosis;

namespace {

Vector6d rms(const std::vector<Vector6d>& residual) {
  Vector6d square = Vector6d::Zero(), count = Vector6d::Zero();
  for (const Vector6d& wrench : residual) {
    for (Eigen::Index axis = 0; axis < 6; ++axis) {
      if (!std::isfinite(wrench[axis])) continue;
      square[axis] += wrench[axis] * wrench[axis];
      count[axis] += 1.0;
    }
  }
  return square.cwiseQuotient(count.cwiseMax(1.0)).cwiseSqrt();
}

test::VirtualDive dive_with(const std::vector<model::ActiveEffect>& effects, unsigned seed) {
  static const model::Vehicle kVehicle = test::vehicle_from_repository("bluerov2");  // outlives the dive
  return test::make_dive(kVehicle, {.duration = 200.0, .dt = 0.04, .seed = seed, .effects = effects});
}

}  // namespace

TEST_CASE("bent base numbers: masses and drag that are a third off leave what the true ones leave") {
  std::mt19937 random{20261124};
  std::uniform_real_distribution<double> any{-1.0, 1.0};
  for (unsigned seed = 1; seed <= 3; ++seed) {
    const test::VirtualDive dive = dive_with({}, seed);
    model::Model bent = dive.truth;
    for (double& number : bent.theta) number *= 1.0 + 0.35 * any(random);
    const Vector6d exact = rms(wrench_residuals(dive.truth, dive.trial));
    const Vector6d off = rms(wrench_residuals(bent, dive.trial));
    const Vector6d unbent = rms(residuals_unbent(bent, {&dive.trial, 1})[0]);
    for (const int axis : {0, 1, 2, 5}) {
      CAPTURE(axis);
      CHECK(off[axis] > 1.5 * exact[axis]);
      CHECK(unbent[axis] < 1.05 * exact[axis]);
    }
  }
}

TEST_CASE("bent base numbers: noise that drowns the accelerations bends nothing") {
  // Least squares would take the noise for the work of a mass that is too large: what then is left of the true
  // accelerations goes with everything.
  const model::Vehicle vehicle = test::vehicle_from_repository("bluerov2");
  for (unsigned seed = 7; seed <= 9; ++seed) {
    test::DiveSettings settings{.duration = 400.0, .dt = 0.04, .seed = seed};
    const test::VirtualDive quiet = test::make_dive(vehicle, settings);
    settings.velocity_noise = settings.rate_noise = 0.15;
    const test::VirtualDive loud = test::make_dive(vehicle, settings);
    std::vector<NamedValue> fitted;
    for (std::size_t i = 0; i < vehicle.parameters.size(); ++i) {
      const double value = loud.truth.theta[model::index(*model::parameter_from_name(vehicle.parameters[i]))];
      fitted.push_back({vehicle.parameters[i], value, 0.05 * std::abs(value), ""});
    }
    const Vector6d exact = rms(wrench_residuals(loud.truth, loud.trial));
    const Vector6d unbent = rms(residuals_unbent(loud.truth, {&loud.trial, 1}, fitted)[0]);
    const Vector6d signal = rms(wrench_residuals(loud.truth, quiet.trial));
    for (const int axis : {0, 1, 2, 5}) {
      CAPTURE(axis);
      REQUIRE(exact[axis] > 3.0 * signal[axis]);
      CHECK(unbent[axis] > 0.85 * exact[axis]);  // numbers known to 5 % may move by three times that
    }
  }
}

TEST_CASE("bent base numbers: what the base model has no number for stays") {
  for (unsigned seed = 4; seed <= 6; ++seed) {
    const test::VirtualDive dive = dive_with({test::active("compressibility", {-6.0})}, seed);
    model::Model lacking = dive.truth;
    lacking.effects.clear();
    const double exact = rms(wrench_residuals(dive.truth, dive.trial))[2];
    const double lacks = rms(residuals_unbent(lacking, {&dive.trial, 1})[0])[2];
    // A constant of it is weight. It pulls back to one depth, so what is left may be small beside the thrust.
    double mean = 0.0, square = 0.0;
    for (const auto& p : dive.trial.p_WB) {
      mean += 6.0 * p.z() / static_cast<double>(dive.trial.size());
      square += 36.0 * p.z() * p.z() / static_cast<double>(dive.trial.size());
    }
    const double force = std::sqrt(square - mean * mean);
    CHECK(std::sqrt(lacks * lacks - exact * exact) > 0.7 * force);
  }
}
