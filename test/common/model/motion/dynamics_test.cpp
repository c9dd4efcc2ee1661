// Signs and sums of docs/model.md: each test's name begins with the number of the convention it holds.
#include "common/model/dynamics.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <random>

#include "common/model/rollout.hpp"
#include "test/support/virtual_dive.hpp"

using namespace fathom;
using model::BaseParameter;

namespace {

constexpr double kRounding = 1e-9;     // N, N m: sums of some ten products near 100
constexpr double kIntegration = 1e-4;  // of the kinetic energy: midpoint steps of 50 ms

model::Vehicle free_body() {
  model::Vehicle vehicle;
  vehicle.name = "free";
  vehicle.dof.fill(true);
  vehicle.mass = 10.0;
  return vehicle;
}

struct Numbers {
  double m_X{12}, m_Y{18}, m_Z{22}, I_X{0.4}, I_Y{0.7}, I_Z{0.9};
};

model::Model body(const model::Vehicle& vehicle, const Numbers& n = {}) {
  model::Model model = model::nominal_model(vehicle, true);
  model.theta.head<6>() << n.m_X, n.m_Y, n.m_Z, n.I_X, n.I_Y, n.I_Z;
  return model;
}

double& at(model::Model& model, BaseParameter parameter) { return model.theta[model::index(parameter)]; }

model::Motion rest(const model::Model& model, const Eigen::Vector3d& euler = Eigen::Vector3d::Zero()) {
  model::Motion motion;
  motion.R_WB = rotation_from_euler(euler);
  motion.force = model::ActuatorForces::Zero(model.allocation.cols());
  motion.vehicle = model.vehicle;
  return motion;
}

Vector6d draw(std::mt19937& random, double scale) {
  std::uniform_real_distribution<double> any{-scale, scale};
  Vector6d x;
  for (double& value : x) value = any(random);
  return x;
}

}  // namespace

TEST_CASE("S1: forward then inverse leaves no residual, for random states and any pair of effects") {
  const model::Vehicle vehicle = test::vehicle_from_repository("beluga");
  std::mt19937 random{1};
  const auto effects = model::all_effects();
  model::Scene scene{.vehicle = &vehicle, .position = true, .attitude = true, .velocity = true, .rates = true};
  scene.nu_rms.setOnes();
  scene.tau_rms.setOnes();
  for (std::size_t a = 0; a < effects.size(); ++a) {
    for (std::size_t b = a; b < effects.size(); ++b) {
      model::Model model = model::nominal_model(vehicle, false);
      for (const std::size_t e : {a, b}) {
        const int second = effects[e]->variants(scene).size() > 1 ? 1 : 0;
        const auto starts = effects[e]->starts(scene, e == b ? second : 0);
        if (!starts.empty()) model.add({effects[e], e == b ? second : 0, "", starts.front()});
      }
      std::vector<double> memory(static_cast<std::size_t>(model.memory_size()), 0.0);
      const Eigen::VectorXd input = Eigen::VectorXd::Random(vehicle.allocation.cols()) * 10.0;
      const std::vector<Eigen::VectorXd> held(2, input);
      const model::InputSignal signal{0.0, 1.0, held};
      model::Motion motion = rest(model, draw(random, 1.0).head<3>());
      motion.nu = draw(random, 1.0);
      motion.p_WB = draw(random, 3.0).head<3>();
      motion.force = input;
      motion.voltage = 14.0;
      motion.input = &signal;
      model::feel(model, motion, memory, 0.1);
      const Vector6d nu_dot = model::acceleration(model, motion);
      CAPTURE(effects[a]->name());
      CAPTURE(effects[b]->name());
      CHECK(nu_dot.norm() > 0.0);
      CHECK(model::residual_wrench(model, motion, nu_dot).norm() < kRounding);
    }
  }
}

TEST_CASE("S2: weight beyond buoyancy sinks") {
  const model::Vehicle vehicle = free_body();
  model::Model model = body(vehicle);
  at(model, BaseParameter::W_B) = 4.4;
  const Vector6d nu_dot = model::acceleration(model, rest(model));
  CHECK(nu_dot[2] == doctest::Approx(4.4 / 22.0));
  CHECK((nu_dot - Vector6d::Unit(2) * nu_dot[2]).norm() < kRounding);
}

TEST_CASE("S3: a low centre of gravity rights the vehicle; one far forward lowers the bow") {
  const model::Vehicle vehicle = free_body();
  model::Model model = body(vehicle);
  at(model, BaseParameter::G_z) = 2.0;
  CHECK(model::acceleration(model, rest(model, {0.2, 0, 1}))[3] == doctest::Approx(-2.0 * std::sin(0.2) / 0.4));
  CHECK(model::acceleration(model, rest(model, {0, 0.2, 1}))[4] == doctest::Approx(-2.0 * std::sin(0.2) / 0.7));
  model = body(vehicle);
  at(model, BaseParameter::G_x) = 1.0;
  CHECK(model::acceleration(model, rest(model))[4] == doctest::Approx(-1.0 / 0.7));
  model = body(vehicle);
  at(model, BaseParameter::G_y) = 1.0;
  CHECK(model::acceleration(model, rest(model))[3] == doctest::Approx(1.0 / 0.4));
}

TEST_CASE("S4: gyroscopic terms do no work: energy stays without drag and never grows with it") {
  const model::Vehicle vehicle = free_body();
  std::mt19937 random{2};
  Trial trial;
  trial.dt = 0.01;
  for (int k = 0; k <= 500; ++k) {
    trial.t.push_back(0.01 * k);
    trial.p_WB.emplace_back(0, 0, 0);
    trial.q_WB.push_back(Eigen::Quaterniond::Identity());
    trial.nu.emplace_back(Vector6d::Zero());
    trial.input.emplace_back(Eigen::VectorXd::Zero(6));
  }
  for (int draws = 0; draws < 5; ++draws) {
    const Vector6d nu0 = draw(random, 1.0);
    for (const bool drag : {false, true}) {
      model::Model model = body(vehicle);
      if (drag) model.theta.segment<12>(6).setConstant(-5.0);
      model::VelocityTrace nu;
      REQUIRE(model::rollout(model, {&trial, 0, trial.size()}, nu0, nu));
      const auto energy = [&](Eigen::Index k) {
        return 0.5 * nu.col(k).dot(model.theta.head<6>().cwiseProduct(nu.col(k)));
      };
      double largest_growth = -1e9;
      for (Eigen::Index k = 1; k < nu.cols(); ++k) {
        largest_growth = std::max(largest_growth, (energy(k) - energy(k - 1)) / energy(0));
      }
      CHECK(largest_growth < kIntegration);
      if (!drag) CHECK(energy(nu.cols() - 1) == doctest::Approx(energy(0)).epsilon(1e-3));
      if (drag) CHECK(energy(nu.cols() - 1) < 0.5 * energy(0));
    }
  }
}

TEST_CASE("S5: the Munk moment turns toward broadside") {
  const model::Vehicle vehicle = free_body();
  const model::Model model = body(vehicle);
  model::Motion motion = rest(model);
  motion.nu << 1.0, 0.2, 0, 0, 0, 0;
  CHECK(model::acceleration(model, motion)[5] == doctest::Approx(-(18.0 - 12.0) * 1.0 * 0.2 / 0.9));
}

TEST_CASE("S6: drag opposes motion through the water, and a drifting vehicle feels none") {
  for (const double mass : {10.0, 0.0}) {  // 0: unknown
    model::Vehicle vehicle = free_body();
    vehicle.mass = mass;
    model::Model model = body(vehicle);
    model.theta.segment<12>(6).setConstant(-3.0);
    model::Motion motion = rest(model, {0, 0, 0.7});
    motion.nu[0] = 0.5;
    CHECK(model::acceleration(model, motion)[0] == doctest::Approx(-(1.5 + 0.75) / 12.0));

    model.add(test::active("current", {0.3, -0.4}));
    motion.nu.setZero();
    motion.nu.head<3>() = motion.R_WB.transpose() * Eigen::Vector3d(0.3, -0.4, 0.0);
    model::feel(model, motion, {}, 0.0);
    CHECK(model::acceleration(model, motion).norm() < kRounding);

    // Pushed north by the water when at rest and pointing north.
    motion = rest(model);
    model::feel(model, motion, {}, 0.0);
    CHECK(model::acceleration(model, motion)[0] > 0.0);
    CHECK(model::acceleration(model, motion)[1] < 0.0);
  }
}

TEST_CASE("S6: a vehicle that turns while it drifts keeps its drift: no force from turning in moving water") {
  const model::Vehicle vehicle = free_body();
  model::Model model = body(vehicle);
  model.add(test::active("current", {0.3, 0.1}));
  model::Motion motion = rest(model, {0, 0, 0.4});
  motion.nu.head<3>() = motion.R_WB.transpose() * Eigen::Vector3d(0.3, 0.1, 0.0);
  motion.nu[5] = 0.5;
  model::feel(model, motion, {}, 0.0);
  // Constant velocity in W, seen from the turning body: nu_dot = -w x v.
  const Eigen::Vector3d expected = -motion.nu.tail<3>().cross(motion.nu.head<3>());
  CHECK((model::acceleration(model, motion).head<3>() - expected).norm() < kRounding);
}

TEST_CASE("S7: a thruster ahead on port turns the vehicle to starboard") {
  const model::Vehicle vehicle = test::vehicle_from_repository("seabotix_lbv150");
  const model::Model model = model::nominal_model(vehicle, false);
  model::Motion motion = rest(model);
  motion.force[0] = 10.0;  // "port"
  const Vector6d nu_dot = model::acceleration(model, motion);
  CHECK(nu_dot[0] == doctest::Approx(10.0 / 9.7532));
  CHECK(nu_dot[5] == doctest::Approx(10.0 * 0.0475 / 0.1589));
  CHECK(nu_dot[3] == 0.0);  // left out
}

TEST_CASE("S8: weight acts along the world's down, whatever the attitude") {
  const model::Vehicle vehicle = free_body();
  model::Model model = body(vehicle, {.m_X = 10, .m_Y = 10, .m_Z = 10});
  at(model, BaseParameter::W_B) = 5.0;
  std::mt19937 random{3};
  for (int i = 0; i < 10; ++i) {
    const model::Motion motion = rest(model, draw(random, 1.5).head<3>());
    const Eigen::Vector3d in_world = motion.R_WB * model::acceleration(model, motion).head<3>();
    CHECK((in_world - Eigen::Vector3d(0, 0, 0.5)).norm() < kRounding);
  }
}

TEST_CASE("S9: every term by hand") {
  const model::Vehicle vehicle = free_body();
  model::Model model = body(vehicle);
  at(model, BaseParameter::X_u) = -5.0;
  at(model, BaseParameter::X_uu) = -20.0;
  at(model, BaseParameter::N_r) = -1.0;
  at(model, BaseParameter::W_B) = 2.0;
  model::Motion motion = rest(model);
  motion.nu << 0.5, -0.2, 0.1, 0.3, 0.4, -0.6;
  motion.force << 7, 8, 9, 1, 2, 3;
  const Vector6d nu_dot = model::acceleration(model, motion);
  // X: 7 - (m_Z q w - m_Y r v) - 5 u - 20 u|u|
  CHECK(nu_dot[0] == doctest::Approx((7 - (22 * 0.4 * 0.1 - 18 * -0.6 * -0.2) - 2.5 - 5.0) / 12.0));
  // Y: 8 - (m_X r u - m_Z p w)
  CHECK(nu_dot[1] == doctest::Approx((8 - (12 * -0.6 * 0.5 - 22 * 0.3 * 0.1)) / 18.0));
  // Z: 9 - (m_Y p v - m_X q u) + W-B
  CHECK(nu_dot[2] == doctest::Approx((9 - (18 * 0.3 * -0.2 - 12 * 0.4 * 0.5) + 2.0) / 22.0));
  // K: 1 - [(m_Z - m_Y) v w + (I_Z - I_Y) q r]
  CHECK(nu_dot[3] == doctest::Approx((1 - (4 * -0.2 * 0.1 + 0.2 * 0.4 * -0.6)) / 0.4));
  // M: 2 - [(m_X - m_Z) u w + (I_X - I_Z) p r]
  CHECK(nu_dot[4] == doctest::Approx((2 - (-10 * 0.5 * 0.1 + -0.5 * 0.3 * -0.6)) / 0.7));
  // N: 3 - [(m_Y - m_X) u v + (I_Y - I_X) p q] - r
  CHECK(nu_dot[5] == doctest::Approx((3 - (6 * 0.5 * -0.2 + 0.3 * 0.3 * 0.4) + 0.6) / 0.9));
}
