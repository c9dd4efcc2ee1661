// Effects of sensors: what they say against what is, both ways, and through a rollout with its derivatives.
#include <doctest/doctest.h>

#include <cmath>

#include "common/model/rollout.hpp"
#include "test/support/virtual_dive.hpp"

using namespace fathom;

namespace {

constexpr double kSensorsRounding = 1e-12;
enum Form { kAll, kVelocity, kRates };

model::VelocityTrace sines(Eigen::Index samples, double dt) {
  model::VelocityTrace nu(6, samples);
  for (Eigen::Index k = 0; k < samples; ++k) {
    for (int axis = 0; axis < 6; ++axis)
      nu(axis, k) = std::sin((0.5 + 0.2 * axis) * dt * static_cast<double>(k) + axis);
  }
  return nu;
}

}  // namespace

TEST_CASE("sensor_latency: shifts by its time, between samples too, and each form its own rows") {
  constexpr double kDt = 0.1;
  // Hermite cubics with central slopes: error below (1/10) dt^3 w^3, w up to 1.5 rad/s.
  constexpr double kInterpolation = 1e-3;
  const model::VelocityTrace truth = sines(200, kDt);
  const model::Effect& effect = *model::find_effect("sensor_latency");
  for (const double latency : {0.03, 0.1, 0.25, 1.2}) {
    for (const int form : {kAll, kVelocity, kRates}) {
      model::VelocityTrace nu = truth;
      model::VelocityView view{nu};
      effect.measure(view, kDt, std::vector{latency}, form);
      for (Eigen::Index k = 13; k + 1 < nu.cols(); ++k) {  // the last has a slope on one side only
        for (int axis = 0; axis < 6; ++axis) {
          const bool late = form == kAll || (axis < 3) == (form == kVelocity);
          const double t = kDt * static_cast<double>(k) - (late ? latency : 0.0);
          CHECK(std::abs(nu(axis, k) - std::sin((0.5 + 0.2 * axis) * t + axis)) < kInterpolation);
        }
      }
    }
  }
}

TEST_CASE("sensor_latency: none is exactly none, whole samples are exact, and the start goes on straight") {
  const model::VelocityTrace truth = sines(50, 0.1);
  const model::Effect& effect = *model::find_effect("sensor_latency");
  model::VelocityTrace nu = truth;
  model::VelocityView view{nu};
  effect.measure(view, 0.1, std::vector{0.0}, kAll);
  CHECK(nu == truth);
  effect.measure(view, 0.1, std::vector{0.3}, kAll);
  CHECK((nu.rightCols(47) - truth.leftCols(47)).norm() < 1e-9);
  const Vector6d slope = truth.col(1) - truth.col(0);
  CHECK((nu.col(0) - (truth.col(0) - 3.0 * slope)).norm() < 1e-9);
}

TEST_CASE("sensor_latency: the way back returns what was, away from the ends") {
  const model::VelocityTrace truth = sines(100, 0.1);
  const model::Effect& effect = *model::find_effect("sensor_latency");
  model::VelocityTrace nu = truth;
  model::VelocityView view{nu};
  effect.measure(view, 0.1, std::vector{0.23}, kAll);
  effect.unmeasure(view, 0.1, std::vector{0.23}, kAll);
  constexpr double kTwice = 3e-3;  // interpolated twice
  CHECK((nu.middleCols(5, 90) - truth.middleCols(5, 90)).cwiseAbs().maxCoeff() < kTwice);
}

TEST_CASE("lever_arm: a log ahead of the origin feels the turning as sway; scale: in proportion; both return") {
  model::VelocityTrace nu = model::VelocityTrace::Zero(6, 3);
  model::VelocityView view{nu};
  nu.row(5).setConstant(0.5);
  const model::VelocityTrace truth = nu;
  const model::Effect& arm = *model::find_effect("lever_arm");
  arm.measure(view, 0.1, std::vector{0.3, -0.2, 0.1}, 0);
  CHECK(nu(1, 1) == doctest::Approx(0.5 * 0.3));
  CHECK(nu(0, 1) == doctest::Approx(0.5 * 0.2));
  CHECK(nu(2, 1) == 0.0);
  arm.unmeasure(view, 0.1, std::vector{0.3, -0.2, 0.1}, 0);
  CHECK((nu - truth).norm() < kSensorsRounding);
  const model::Effect& scale = *model::find_effect("sensor_scale");
  scale.measure(view, 0.1, std::vector{0.1}, 5);
  CHECK(nu(5, 2) == doctest::Approx(0.55));
  scale.unmeasure(view, 0.1, std::vector{0.1}, 5);
  CHECK((nu - truth).norm() < kSensorsRounding);
}

TEST_CASE("effects of sensors: a rollout says what they say, and a prediction begins at what is") {
  const model::Vehicle vehicle = test::vehicle_from_repository("seabotix_lbv150");
  const test::VirtualDive dive = test::make_dive(
      vehicle,
      {.duration = 20.0,
       .seed = 9,
       .velocity_noise = 0.0,
       .rate_noise = 0.0,
       .effects = {test::active("lever_arm", {0.3, -0.2, 0.0}), test::active("sensor_latency", {0.2}, kVelocity)}});
  const test::VirtualDive plain =
      test::make_dive(vehicle, {.duration = 20.0, .seed = 9, .velocity_noise = 0.0, .rate_noise = 0.0});
  constexpr double kBack = 5e-3;  // m/s: interpolation of a motion with steps of thrust, twice
  for (std::size_t k = 10; k + 30 < dive.trial.size(); k += 20) {
    CHECK((model::true_velocity(dive.truth, dive.trial, k) - plain.trial.nu[k]).norm() < kBack);
    CHECK(model::true_velocity(plain.truth, plain.trial, k) == plain.trial.nu[k]);
  }
  model::VelocityTrace nu;
  REQUIRE(model::rollout(dive.truth, {&dive.trial, 0, 101}, plain.trial.nu[0], nu));
  constexpr double kSteps = 0.01;  // steps of 50 ms against those of 10 ms
  for (Eigen::Index k = 5; k < nu.cols(); ++k) {
    CHECK((nu.col(k) - dive.trial.nu[static_cast<std::size_t>(k)]).norm() < kSteps);
  }
}

TEST_CASE("effects of sensors: derivatives go the way of the velocities") {
  const model::Vehicle vehicle = test::vehicle_from_repository("seabotix_lbv150");
  const test::VirtualDive dive = test::make_dive(vehicle, {.duration = 20.0,
                                                           .seed = 9,
                                                           .effects = {test::active("lever_arm", {0.3, -0.2, 0.0}),
                                                                       test::active("sensor_latency", {0.15}, kAll)}});
  const model::Window window{&dive.trial, 50, 51};
  const Vector6d nu0 = dive.trial.nu[50];
  model::VelocityTrace nu, moved;
  model::VelocityDerivatives derivatives;
  REQUIRE(model::rollout_with_derivatives(dive.truth, window, nu0, nu, derivatives));
  constexpr double kVariational = 0.02;  // yaw of this vehicle settles within a few steps
  for (const auto parameter : {model::BaseParameter::m_X, model::BaseParameter::Y_v, model::BaseParameter::N_r}) {
    const int j = model::index(parameter);
    model::Model shifted = dive.truth;
    const double step = 1e-4 * std::abs(shifted.theta[j]);
    shifted.theta[j] += step;
    REQUIRE(model::rollout(shifted, window, nu0, moved));
    const model::VelocityTrace by_difference = (moved - nu) / step;
    double worst = 0.0;
    for (Eigen::Index k = 0; k < nu.cols(); ++k) {
      for (int axis = 0; axis < 6; ++axis) {
        worst = std::max(worst, std::abs(derivatives(6 * k + axis, j) - by_difference(axis, k)));
      }
    }
    CHECK(worst < kVariational * by_difference.cwiseAbs().maxCoeff());
  }
}

TEST_CASE("effects of sensors: asked for where their signal exists") {
  const model::Vehicle vehicle = test::vehicle_from_repository("seabotix_lbv150");
  model::Scene scene{.vehicle = &vehicle, .velocity = true, .rates = true};
  scene.nu_rms.setConstant(0.3);
  CHECK(model::find_effect("lever_arm")->variants(scene).size() == 1);
  scene.nu_rms.segment<2>(3).setZero();  // no roll, no pitch: heave couples with nothing, so its scale cannot show
  CHECK(model::find_effect("sensor_scale")->variants(scene) == std::vector<std::string>{"u", "v", "-", "-", "-", "r"});
  CHECK(model::find_effect("sensor_latency")->variants(scene)[1] == "velocity");
  scene.velocity = false;
  CHECK(model::find_effect("lever_arm")->variants(scene).empty());
  CHECK(model::find_effect("sensor_scale")->variants(scene)[0] == "-");
  CHECK(model::find_effect("sensor_latency")->variants(scene)[1] == "-");
}
