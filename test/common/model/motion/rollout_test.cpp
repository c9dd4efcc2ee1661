// Open-loop simulation against formulas and against itself with fine steps.
#include "common/model/rollout.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <functional>

#include "test/support/virtual_dive.hpp"

using namespace fathom;

namespace {

constexpr double kMidpoint = 2e-3;     // of nu: midpoint steps of 50 ms against the exact solution
constexpr double kExact = 1e-9;        // of the terminal speed
constexpr double kQuickSquare = 1e-2;  // of the terminal speed: its slope changes by a third within a step

model::Vehicle surge_only() {
  model::Vehicle vehicle;
  vehicle.name = "surge";
  vehicle.dof = {true, false, false, false, false, false};
  vehicle.mass = 10.0;
  return vehicle;
}

model::Model surge_model(const model::Vehicle& vehicle) {
  model::Model model = model::nominal_model(vehicle, true);
  model.theta.head<6>() << 20, 20, 20, 1, 1, 1;
  return model;
}

Trial run_with(double duration, double dt, const std::function<double(double)>& surge_force) {
  Trial trial;
  trial.dt = dt;
  trial.input_is_wrench = true;
  trial.observed = {true, true, true, true};
  for (std::size_t k = 0; k <= static_cast<std::size_t>(std::lround(duration / dt)); ++k) {
    trial.t.push_back(static_cast<double>(k) * dt);
    trial.p_WB.emplace_back(0, 0, 0);
    trial.q_WB.push_back(Eigen::Quaterniond::Identity());
    trial.nu.emplace_back(Vector6d::Zero());
    trial.input.emplace_back(Eigen::VectorXd::Unit(6, 0) * surge_force(trial.t.back()));
  }
  return trial;
}

}  // namespace

TEST_CASE("rollout: constant thrust approaches the terminal speed as the hyperbolic tangent") {
  const model::Vehicle vehicle = surge_only();
  model::Model model = surge_model(vehicle);
  model.theta[model::index(model::BaseParameter::X_uu)] = -40.0;
  const Trial trial = run_with(10.0, 0.1, [](double) { return 10.0; });
  model::VelocityTrace nu;
  REQUIRE(model::rollout(model, {&trial, 0, trial.size()}, Vector6d::Zero(), nu));
  const double terminal = std::sqrt(10.0 / 40.0);
  for (Eigen::Index k = 0; k < nu.cols(); ++k) {
    const double expected = terminal * std::tanh(trial.t[static_cast<std::size_t>(k)] * std::sqrt(10.0 * 40.0) / 20.0);
    CHECK(std::abs(nu(0, k) - expected) < kMidpoint * terminal);
  }
  CHECK(nu(0, nu.cols() - 1) == doctest::Approx(terminal).epsilon(1e-3));
}

TEST_CASE("rollout: an axis that settles within a few steps follows the exponential and the hyperbolic tangent") {
  const model::Vehicle vehicle = surge_only();
  model::Model model = surge_model(vehicle);
  const Trial trial = run_with(1.0, 0.02, [](double) { return 10.0; });
  model::VelocityTrace nu;
  SUBCASE("linear drag") {
    for (const double settles : {0.2, 0.1, 0.05, 0.02}) {  // s
      model.theta[model::index(model::BaseParameter::X_u)] = -20.0 / settles;
      REQUIRE(model::rollout(model, {&trial, 0, trial.size()}, Vector6d::Zero(), nu));
      for (Eigen::Index k = 0; k < nu.cols(); ++k) {
        const double expected = 1.0 - std::exp(-trial.t[static_cast<std::size_t>(k)] / settles);
        CHECK(std::abs(nu(0, k) / (10.0 * settles / 20.0) - expected) < kExact);
      }
    }
  }
  SUBCASE("linear drag, thrust that grows") {
    constexpr double kSettles = 0.1;  // s
    model.theta[model::index(model::BaseParameter::X_u)] = -20.0 / kSettles;
    const Trial growing = run_with(1.0, 0.02, [](double t) { return 10.0 * t; });
    REQUIRE(model::rollout(model, {&growing, 0, growing.size()}, Vector6d::Zero(), nu));
    for (Eigen::Index k = 0; k < nu.cols(); ++k) {
      const double t = growing.t[static_cast<std::size_t>(k)];
      const double expected = t - kSettles * (1.0 - std::exp(-t / kSettles));
      CHECK(std::abs(nu(0, k) / (10.0 * kSettles / 20.0) - expected) < kExact);
    }
  }
  SUBCASE("quadratic drag") {
    constexpr double kTerminal = 0.05, kSettles = 0.1;  // m/s, s: 2 m / F times the terminal speed is twice that
    model.theta[model::index(model::BaseParameter::X_uu)] = -10.0 / (kTerminal * kTerminal);
    REQUIRE(model::rollout(model, {&trial, 0, trial.size()}, Vector6d::Zero(), nu));
    for (Eigen::Index k = 0; k < nu.cols(); ++k) {
      const double expected = std::tanh(trial.t[static_cast<std::size_t>(k)] / kSettles);
      CHECK(std::abs(nu(0, k) / kTerminal - expected) < kQuickSquare);
    }
  }
}

TEST_CASE("rollout: six axes agree with integration at a fifth of the step") {
  const model::Vehicle vehicle = test::vehicle_from_repository("beluga");
  const test::VirtualDive dive = test::make_dive(
      vehicle, {.duration = 20.0,
                .seed = 6,
                .velocity_noise = 0.0,
                .rate_noise = 0.0,
                .effects = {test::active("thruster_lag", {0.2}), test::active("current", {0.1, 0.05})}});
  model::VelocityTrace nu;
  REQUIRE(model::rollout(dive.truth, {&dive.trial, 0, dive.trial.size()}, dive.trial.nu[0], nu));
  double worst = 0.0;
  for (Eigen::Index k = 0; k < nu.cols(); ++k) {
    worst = std::max(worst, (nu.col(k) - dive.trial.nu[static_cast<std::size_t>(k)]).cwiseAbs().maxCoeff());
  }
  constexpr double kFine = 0.01;  // m/s, rad/s, over 20 s of open loop
  CHECK(worst < kFine);
}

TEST_CASE("rollout: left-out degrees of freedom follow the measurement") {
  const model::Vehicle vehicle = surge_only();
  const model::Model model = surge_model(vehicle);
  Trial trial = run_with(2.0, 0.1, [](double) { return 0.0; });
  for (std::size_t k = 0; k < trial.size(); ++k) {
    trial.nu[k][1] = 0.3;                                     // sway
    trial.nu[k][5] = 0.2;                                     // yaw
    trial.nu[k][2] = 0.1 * std::sin(static_cast<double>(k));  // heave
  }
  model::VelocityTrace nu;
  REQUIRE(model::rollout(model, {&trial, 0, trial.size()}, Vector6d::Zero(), nu));
  for (Eigen::Index k = 0; k < nu.cols(); ++k) {
    CHECK((nu.col(k).tail<5>() - trial.nu[static_cast<std::size_t>(k)].tail<5>()).norm() < 1e-12);
  }
  CHECK(nu(0, nu.cols() - 1) == doctest::Approx(0.3 * 0.2 * 2.0));  // m_Y v r / m_X, for two seconds
}

TEST_CASE("rollout: a first-order lag rounds a step as the exponential says") {
  const model::Vehicle vehicle = surge_only();
  model::Model model = surge_model(vehicle);
  model.add(test::active("thruster_lag", {0.4}));
  const Trial trial = run_with(5.0, 0.05, [](double t) { return t >= 2.0 ? 10.0 : 0.0; });
  model::VelocityTrace nu;
  REQUIRE(model::rollout(model, {&trial, 0, trial.size()}, Vector6d::Zero(), nu));
  for (std::size_t k = 45; k < trial.size(); ++k) {
    const double s = trial.t[k] - 2.0 + 0.025;  // the logged step is a ramp of one sample: half a sample early
    const double expected = 10.0 / 20.0 * (s - 0.4 * (1.0 - std::exp(-s / 0.4)));
    CHECK(nu(0, static_cast<Eigen::Index>(k)) == doctest::Approx(expected).epsilon(0.01));
  }
}

TEST_CASE("rollout: a delay shifts the response and changes nothing else") {
  const model::Vehicle vehicle = surge_only();
  model::Model model = surge_model(vehicle);
  model.theta[model::index(model::BaseParameter::X_u)] = -10.0;
  const Trial trial = run_with(6.0, 0.05, [](double t) { return t >= 2.0 ? 10.0 * std::sin(2.0 * t) : 0.0; });
  model::VelocityTrace prompt, late;
  REQUIRE(model::rollout(model, {&trial, 0, trial.size()}, Vector6d::Zero(), prompt));
  model.add(test::active("thruster_delay", {0.3}));
  REQUIRE(model::rollout(model, {&trial, 0, trial.size()}, Vector6d::Zero(), late));
  for (Eigen::Index k = 6; k < late.cols(); ++k) CHECK(late(0, k) == doctest::Approx(prompt(0, k - 6)).epsilon(1e-9));
}

TEST_CASE("rollout: a diverging model says so and stays finite") {
  const model::Vehicle vehicle = surge_only();
  model::Model model = surge_model(vehicle);
  model.theta[model::index(model::BaseParameter::X_u)] = 400.0;  // feeds on itself
  const Trial trial = run_with(20.0, 0.1, [](double) { return 1.0; });
  model::VelocityTrace nu;
  CHECK_FALSE(model::rollout(model, {&trial, 0, trial.size()}, Vector6d::Zero(), nu));
  CHECK(nu.allFinite());
}

TEST_CASE("rollout: drag that is stiff for ordinary steps is followed all the same") {
  const model::Vehicle vehicle = test::vehicle_from_repository("seabotix_lbv150");  // yaw settles in 15 ms
  const test::VirtualDive dive =
      test::make_dive(vehicle, {.duration = 20.0, .seed = 7, .velocity_noise = 0.0, .rate_noise = 0.0});
  model::VelocityTrace nu;
  REQUIRE(model::rollout(dive.truth, {&dive.trial, 0, dive.trial.size()}, dive.trial.nu[0], nu));
  double worst = 0.0;
  for (Eigen::Index k = 0; k < nu.cols(); ++k) {
    worst = std::max(worst, std::abs(nu(5, k) - dive.trial.nu[static_cast<std::size_t>(k)][5]));
  }
  constexpr double kStiff = 0.03;  // rad/s of 0.4: just after steps of thrust
  CHECK(worst < kStiff);
}
