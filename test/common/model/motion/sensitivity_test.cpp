// The variational equation against central differences of rollouts: six axes, and fewer with the tilt as measured, with
// effects that bend the water, the place, the time and the inertia.
#include "common/model/derivatives/sensitivity.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "common/base/spatial.hpp"
#include "test/support/virtual_dive.hpp"

using namespace fathom;

namespace {

constexpr double kQuick = 0.04;  // of a column: yaw that settles in three steps, one slope per step, water that turns
constexpr double kAgreement = 0.01;    // of a column: what rollout.hpp promises
constexpr double kStep = 1e-4;         // of the parameter: truncation and rounding both far below the agreement
constexpr double kInitialStep = 1e-4;  // m/s, rad/s
constexpr double kNoise = 1e-7;        // of a column's unit: rounding of the difference

struct Worst {
  double share{};
  std::string column;
};

/// Largest disagreement of a column, over the enabled parameters and the initial velocity.
Worst compare(const model::Model& model, const model::Window& window) {
  const Vector6d nu0 = window.trial->nu[window.start];
  model::VelocityTrace trace, plus, minus;
  model::VelocityDerivatives derivatives;
  REQUIRE(model::rollout_with_derivatives(model, window, nu0, trace, derivatives));
  model::VelocityTrace plain;
  REQUIRE(model::rollout(model, window, nu0, plain));
  CHECK((plain - trace).norm() == 0.0);
  REQUIRE(derivatives.rows() == 6 * static_cast<Eigen::Index>(window.count));
  Worst worst;
  const auto judge = [&](Eigen::Index column, double step, const std::string& name) {
    const Eigen::MatrixXd central = (plus - minus) / (2.0 * step);
    const Eigen::VectorXd expected = central.reshaped();
    const double error = (derivatives.col(column) - expected).norm();
    const double share = std::max(error - kNoise, 0.0) / std::max(expected.norm(), 1e-12);
    if (share > worst.share) worst = {share, name};
  };
  for (const std::string& name : model.vehicle->parameters) {
    const int i = model::index(*model::parameter_from_name(name));
    const double step = kStep * std::max(std::abs(model.theta[i]), 0.1);
    model::Model moved = model;
    moved.theta[i] = model.theta[i] + step;
    REQUIRE(model::rollout(moved, window, nu0, plus));
    moved.theta[i] = model.theta[i] - step;
    REQUIRE(model::rollout(moved, window, nu0, minus));
    judge(i, step, name);
  }
  for (Eigen::Index axis = 0; axis < 6; ++axis) {
    const Eigen::Index column = model::kBaseParameterCount + axis;
    if (!model.vehicle->dof[static_cast<std::size_t>(axis)]) {
      CHECK(derivatives.col(column).isZero(0.0));
      continue;
    }
    REQUIRE(model::rollout(model, window, nu0 + kInitialStep * Vector6d::Unit(axis), plus));
    REQUIRE(model::rollout(model, window, nu0 - kInitialStep * Vector6d::Unit(axis), minus));
    judge(column, kInitialStep, std::string("initial ") + model::kVelocityNames[static_cast<std::size_t>(axis)]);
  }
  return worst;
}

/// Four axes; ballast on a long frame keeps yaw from being so quick that its derivatives live within one step.
model::Vehicle four_axes() {
  model::Vehicle vehicle = test::vehicle_from_repository("seabotix_lbv150");
  for (std::size_t i = 0; i < vehicle.parameters.size(); ++i) {
    if (vehicle.parameters[i] == "I_Z") vehicle.priors[i] = {.mean = 2.0, .sigma = 2.0};
  }
  return vehicle;
}

void check(const model::Vehicle& vehicle, const std::vector<model::ActiveEffect>& effects, unsigned seed,
           double agreement = kAgreement, double tilt = 0.0) {
  test::VirtualDive dive =
      test::make_dive(vehicle, {.duration = 24.0, .seed = seed, .velocity_noise = 0.0, .rate_noise = 0.0});
  for (std::size_t k = 0; k < dive.trial.size(); ++k) {
    // Rolling and pitching as if measured, on top of the heading.
    const double t = dive.trial.t[k];
    const Eigen::Quaterniond lean = quaternion_from_rotation_vector({tilt * std::sin(0.8 * t), tilt * std::cos(t), 0});
    dive.trial.q_WB[k] = dive.trial.q_WB[k] * lean;
    if (tilt > 0.0) {
      dive.trial.nu[k][3] = tilt * 0.8 * std::cos(0.8 * t);
      dive.trial.nu[k][4] = -tilt * std::sin(t);
    }
  }
  for (const auto& effect : effects) dive.truth.add(effect);
  for (const std::size_t start : {std::size_t{40}, std::size_t{130}}) {
    const Worst worst = compare(dive.truth, {&dive.trial, start, 101});
    CAPTURE(vehicle.name);
    CAPTURE(effects.empty() ? "no effect" : effects.front().effect->name());
    CAPTURE(worst.column);
    CAPTURE(start);
    CHECK(worst.share < agreement);
  }
}

model::ActiveEffect added_inertia(const model::Vehicle& vehicle) {
  model::Scene scene{.vehicle = &vehicle};
  scene.nu_rms.setOnes();
  const auto names = model::find_effect("cross_coupling")->variants(scene);
  const auto place = std::find(names.begin(), names.end(), "Y_r_dot");
  REQUIRE(place != names.end());
  return test::active("cross_coupling", {0.05}, static_cast<int>(place - names.begin()));
}

const std::vector<double> kTether{1.5, 1.0, 1.5, 0.5, 0.0};

}  // namespace

TEST_CASE("sensitivity: six axes, with nothing and with each kind of effect") {
  const model::Vehicle vehicle = test::vehicle_from_repository("beluga");
  check(vehicle, {}, 71);
  check(vehicle, {test::active("current", {0.1, -0.05})}, 72);
  check(vehicle, {test::active("tether_tension", kTether)}, 73);
  check(vehicle, {test::active("thruster_lag", {0.25})}, 74);
  check(vehicle, {test::active("tether_tension", {1.5, 1.0, 1.5, 0.5, 0.0, -0.3, 0.05, -0.1}, 7)}, 87);
  check(vehicle, {test::active("tether_drag", {4.0, 1.5, 0.5, 0.0, -0.3, 0.05, -0.1}, 7)}, 88);
  check(vehicle, {test::active("tether_drag", {4.0, 1.5, 0.5, 0.0}, 9)}, 91);
  check(vehicle, {test::active("thruster_lag", {0.25}, 2), test::active("thruster_delay", {0.1, 0.2}, 1)}, 89);
  check(vehicle, {test::active("centre_of_mass", {0.05, -0.03, 0.02}, 7)}, 85);
  check(vehicle, {test::active("ventilation", {0.5, 0.3, 0.0})}, 93);
  check(vehicle, {test::active("switching_moment", {0.1, 0.5}, 2)}, 94);
  check(vehicle, {test::active("fluid_memory", {20.0, 30.0, 30.0, 2.0, 2.0, 2.0, 1.5, 0.0}, 6 + 63)}, 90);
  check(vehicle, {test::active("fluid_memory", {20.0, 30.0, 30.0, 2.0, 2.0, 2.0, 1.5, 0.9}, 70 + 6 + 63)}, 92);
}

TEST_CASE("sensitivity: where a boundary makes the hull's drag several times as large, its numbers count as often") {
  constexpr int kExponentialDrag = 3, kSuction = 4;
  const model::Vehicle vehicle = test::vehicle_from_repository("beluga");
  check(vehicle, {test::active("wall_effect", {2.0, 0.3, 0.0, 0.5, 2.0}, kExponentialDrag)}, 83);
  check(four_axes(), {test::active("bottom_effect", {1.5, 0.0, 0.4, 0.5}, kExponentialDrag)}, 84);
  check(four_axes(), {test::active("bottom_effect", {9.0, 2.5, 0.0, 0.0}, kSuction)}, 85);
  check(four_axes(), {test::active("thruster_lag", {0.3, 0.0}, 4)}, 86);
}

TEST_CASE("sensitivity: five axes: roll is simulated, tilt is as measured, heading is simulated") {
  const model::Vehicle vehicle = test::vehicle_from_repository("bluerov2");
  check(vehicle, {}, 75, kQuick);
  check(vehicle, {test::active("current", {0.1, -0.05}), test::active("thruster_lag", {0.25})}, 76, kQuick);
}

TEST_CASE("sensitivity: four axes with the tilt as measured") {
  constexpr double kTilt = 0.15;  // rad
  const model::Vehicle vehicle = four_axes();
  check(vehicle, {}, 77, kAgreement, kTilt);
  check(vehicle, {test::active("current", {0.1, -0.05})}, 78, kAgreement, kTilt);
  check(vehicle, {test::active("tether_tension", kTether)}, 79, kAgreement, kTilt);
  check(vehicle, {test::active("thruster_lag", {0.25}), test::active("thruster_delay", {0.15})}, 80, kAgreement, kTilt);
  check(vehicle, {added_inertia(vehicle)}, 81, kAgreement, kTilt);
  check(vehicle, {test::active("centre_of_mass", {0.05, -0.03, 0.0}, 3)}, 86, kAgreement, kTilt);
  check(vehicle, {test::active("fluid_memory", {12.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0}, 0)}, 91, kAgreement, kTilt);
}

TEST_CASE("sensitivity: a trajectory that diverges hands out nothing, and nothing that is not a number") {
  const model::Vehicle vehicle = test::vehicle_from_repository("seabotix_lbv150");
  const test::VirtualDive dive = test::make_dive(vehicle, {.duration = 30.0, .seed = 82});
  model::Model model = dive.truth;
  model.theta[model::index(model::BaseParameter::X_u)] = 400.0;  // feeds on itself
  model.theta[model::index(model::BaseParameter::X_uu)] = 0.0;
  model::VelocityTrace trace;
  model::VelocityDerivatives derivatives;
  CHECK_FALSE(model::rollout_with_derivatives(model, {&dive.trial, 0, dive.trial.size()}, dive.trial.nu[0], trace,
                                              derivatives));
  CHECK(trace.allFinite());
  CHECK(derivatives.allFinite());
}
