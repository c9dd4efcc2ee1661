// Waves: kinematics of the water by difference and by hand, and the spectrum that gives starts.
#include <doctest/doctest.h>

#include <Eigen/LU>
#include <cmath>
#include <numbers>

#include "common/model/rollout.hpp"
#include "common/model/tones.hpp"
#include "test/support/virtual_dive.hpp"

using namespace fathom;

namespace {

constexpr double kWaveRounding = 1e-12;
enum WaveForm { kForce, kHeave, kOrbital };

model::Motion felt(const std::vector<double>& theta, double t, const Eigen::Vector3d& p) {
  model::Motion motion{.t = t, .p_WB = p, .R_WB = rotation_from_euler({0.1, 0.2, 0.7})};
  model::find_effect("wave")->feel(motion, theta, kOrbital, {});
  return motion;
}

}  // namespace

TEST_CASE("wave: a force along its bearing that swings with time alone") {
  model::Motion motion{.t = 2.0};
  motion.R_WB = rotation_from_euler({0.0, 0.0, 0.5 * std::numbers::pi});  // looking east
  model::Load load;
  model::find_effect("wave")->load(motion, std::vector{2.0, 1.0, 0.0, 0.8}, kForce, load);
  const double north = 2.0 * std::cos(1.6) + std::sin(1.6);
  CHECK((load.wrench.head<3>() - Eigen::Vector3d(0.0, -north, 0.0)).norm() < kWaveRounding);
  model::Load up;
  model::find_effect("wave")->load(motion, std::vector{2.0, 1.0, 0.0, 0.8}, kHeave, up);
  CHECK(up.wrench[2] == doctest::Approx(north));
}

TEST_CASE("wave: orbital motion goes in circles, decays with depth and is as fast in all places") {
  const std::vector<double> theta{0.1, 0.05, 0.6, 1.4};
  const double speed = std::hypot(0.1, 0.05);
  constexpr double kGravity = 9.81;
  for (const double t : {0.0, 0.7, 3.1}) {
    CHECK(felt(theta, t, {1.0, 2.0, 0.0}).v_WF_B.norm() == doctest::Approx(speed));
    CHECK(felt(theta, t, {1.0, 2.0, 3.0}).v_WF_B.norm() ==
          doctest::Approx(speed * std::exp(-1.4 * 1.4 / kGravity * 3.0)));
  }
}

TEST_CASE("wave: the water's acceleration is the change of its velocity, and it neither thins nor turns in itself") {
  const std::vector<double> theta{0.1, 0.05, 0.6, 1.4};
  const Eigen::Vector3d p{1.0, -2.0, 0.5};
  constexpr double kStep = 1e-5, kDifference = 1e-8;
  const model::Motion here = felt(theta, 2.0, p);
  const Eigen::Vector3d slope =
      (felt(theta, 2.0 + kStep, p).v_WF_B - felt(theta, 2.0 - kStep, p).v_WF_B) / (2.0 * kStep);
  CHECK((slope - here.a_WF_B).norm() < kDifference);
  Eigen::Matrix3d gradient;  // in W
  for (int j = 0; j < 3; ++j) {
    const Eigen::Vector3d e = kStep * Eigen::Vector3d::Unit(j);
    gradient.col(j) =
        here.R_WB * (felt(theta, 2.0, p + e).v_WF_B - felt(theta, 2.0 - 0.0, p - e).v_WF_B) / (2.0 * kStep);
  }
  CHECK(std::abs(gradient.trace()) < kDifference);                // continuity
  CHECK((gradient - gradient.transpose()).norm() < kDifference);  // potential flow
}

TEST_CASE("wave: a neutral vehicle that moves with the water goes on moving with it") {
  model::Vehicle vehicle;
  vehicle.name = "drifter";
  vehicle.dof = {true, true, true, false, false, false};
  vehicle.mass = 10.0;
  model::Model model = model::nominal_model(vehicle, true);
  model.theta.setZero();
  model.theta.head<6>() << 20, 20, 20, 1, 1, 1;
  const std::vector<double> theta{0.05, 0.02, 0.6, 1.0};
  model.add(test::active("wave", theta, kOrbital));
  Trial trial;
  trial.dt = 0.1;
  trial.input_is_wrench = true;
  trial.observed = {true, true, true, true};
  for (std::size_t k = 0; k <= 40; ++k) {
    trial.t.push_back(0.1 * static_cast<double>(k));
    trial.p_WB.emplace_back(0, 0, 0);
    trial.q_WB.push_back(Eigen::Quaterniond::Identity());
    trial.nu.emplace_back(Vector6d::Zero());
    trial.input.emplace_back(Vector6d::Zero());
  }
  model::Motion start;
  model::find_effect("wave")->feel(start, theta, kOrbital, {});
  Vector6d nu0 = Vector6d::Zero();
  nu0.head<3>() = start.v_WF_B;
  model::VelocityTrace nu;
  REQUIRE(model::rollout(model, {&trial, 0, trial.size()}, nu0, nu));
  Eigen::Vector3d p = Eigen::Vector3d::Zero();
  constexpr double kConvective =
      0.03;  // of the speed: its change along the particle's own way is left out, and adds up
  for (Eigen::Index k = 0; k < nu.cols(); ++k) {
    model::Motion water{.t = trial.t[static_cast<std::size_t>(k)], .p_WB = p};
    model::find_effect("wave")->feel(water, theta, kOrbital, {});
    CHECK((nu.col(k).head<3>() - water.v_WF_B).norm() < kConvective * start.v_WF_B.norm());
    if (k + 1 < nu.cols()) p += 0.05 * (nu.col(k) + nu.col(k + 1)).head<3>();
  }
}

TEST_CASE("tones: a hidden wave is the strongest, at its frequency and bearing") {
  const model::Vehicle vehicle = test::vehicle_from_repository("bluerov2");
  const std::vector<double> hidden{1.5, -1.0, 0.9, 1.1};
  const test::VirtualDive dive =
      test::make_dive(vehicle, {.duration = 200.0, .seed = 5, .effects = {test::active("wave", hidden, kForce)}});
  const model::Scene scene = model::scene_of(vehicle, {&dive.trial, 1});
  REQUIRE_FALSE(scene.tones_horizontal.empty());
  CHECK(std::abs(scene.tones_horizontal[0].omega - 1.1) < std::numbers::pi / 200.0);
  const auto starts = model::find_effect("wave")->starts(scene, kForce);
  constexpr double kRough = 0.2;  // rad: a start, not an estimate
  CHECK(std::abs(std::remainder(starts[0][2] - 0.9, std::numbers::pi)) < kRough);
  CHECK(std::hypot(starts[0][0], starts[0][1]) == doctest::Approx(std::hypot(1.5, 1.0)).epsilon(0.3));
  Trial blind = dive.trial;
  blind.observed.attitude = false;
  CHECK(model::find_effect("wave")->variants(model::scene_of(vehicle, {&blind, 1})).empty());
}

TEST_CASE("wave: a search for orbits begins with both ways that the same to and fro may travel") {
  const model::Vehicle vehicle = test::vehicle_from_repository("seabotix_lbv150");
  model::Scene scene{.vehicle = &vehicle, .position = true};
  scene.tones_horizontal = {{.omega = 1.2, .cosine = {2.0, 1.0, 0.0}, .sine = {-1.0, -0.5, 0.0}}};
  const auto starts = model::find_effect("wave")->starts(scene, kOrbital);
  REQUIRE(starts.size() == 2);
  const Eigen::Vector3d origin = Eigen::Vector3d::Zero();
  const Eigen::Vector3d one = felt(starts[0], 0.4, origin).v_WF_B, other = felt(starts[1], 0.4, origin).v_WF_B;
  const Eigen::Matrix3d R_WB = felt(starts[0], 0.4, origin).R_WB;
  CHECK((R_WB * (one - other)).head<2>().norm() < kWaveRounding);
  CHECK(std::abs((R_WB * (one + other)).z()) < kWaveRounding);
  CHECK(std::abs((R_WB * one).z()) > 1e-3);
}
