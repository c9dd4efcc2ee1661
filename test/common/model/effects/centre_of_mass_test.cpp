// centre_of_mass against Newton and Euler at the centre of mass itself, where nothing is off-diagonal.
#include <doctest/doctest.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <random>

#include "common/model/dynamics.hpp"
#include "common/model/rollout.hpp"
#include "test/support/virtual_dive.hpp"

using namespace fathom;

namespace {

constexpr double kRounding = 1e-12;
constexpr double kMidpoint = 2e-3;  // m/s: midpoint steps of 50 ms over ten seconds of tumbling
constexpr double kMass = 12.0;
constexpr int kAll = 7, kHorizontal = 3;  // forms: sets of components
const Eigen::Vector3d kInertia{0.4, 0.7, 0.9};
const std::vector<double> kPlace{0.12, -0.05, 0.03};
const Eigen::Vector3d kArm{kPlace[0], kPlace[1], kPlace[2]};

/// A body in a vacuum, without weight.
struct Free {
  Free() {
    vehicle.name = "free";
    vehicle.dof.fill(true);
    vehicle.mass = kMass;
    model = model::nominal_model(vehicle, true);
    model.theta.setZero();
    model.theta.head<6>() << kMass, kMass, kMass, kInertia;
    model.add(test::active("centre_of_mass", kPlace, kAll));
  }
  [[nodiscard]] model::Motion motion(std::mt19937& random) const {
    std::normal_distribution<double> normal;
    model::Motion motion;
    motion.vehicle = &vehicle;
    motion.force = Vector6d::Zero();
    for (int axis = 0; axis < 6; ++axis) {
      motion.nu[axis] = normal(random);
      motion.force[axis] = 10.0 * normal(random);
    }
    return motion;
  }
  model::Vehicle vehicle;
  model::Model model;
};

}  // namespace

TEST_CASE("centre_of_mass: force and moment are those of Newton and Euler at the centre of mass") {
  const Free free;
  std::mt19937 random{11};
  for (int i = 0; i < 20; ++i) {
    const model::Motion motion = free.motion(random);
    const Vector6d nu_dot = model::acceleration(free.model, motion);
    const Eigen::Vector3d v = motion.nu.head<3>(), w = motion.nu.tail<3>(), w_dot = nu_dot.tail<3>();
    const Eigen::Vector3d a_G = nu_dot.head<3>() + w.cross(v) + w_dot.cross(kArm) + w.cross(w.cross(kArm));
    const Eigen::Vector3d spin = kInertia.cwiseProduct(w_dot) + w.cross(kInertia.cwiseProduct(w));
    CHECK((kMass * a_G - motion.force.head<3>()).norm() < 1e3 * kRounding);
    CHECK((spin + kArm.cross(kMass * a_G) - motion.force.tail<3>()).norm() < 1e3 * kRounding);
    CHECK(model::residual_wrench(free.model, motion, nu_dot).norm() < 1e3 * kRounding);
  }
}

TEST_CASE("centre_of_mass: signs by hand: sideways thrust at the origin turns the bow with it, mass ahead resists") {
  Free free;
  model::Motion motion;
  motion.vehicle = &free.vehicle;
  motion.force = Vector6d::Zero();
  motion.force[1] = 6.0;  // N to starboard
  free.model.effects.front().theta = {0.2, 0.0, 0.0};
  const Vector6d nu_dot = model::acceleration(free.model, motion);
  CHECK(nu_dot[5] == doctest::Approx(-0.2 * 6.0 / kInertia[2]));  // behind the mass: the bow swings to port
  CHECK(nu_dot[1] == doctest::Approx(6.0 / kMass + 0.2 * 0.2 * 6.0 / kInertia[2]));
  motion.force.setZero();
  motion.nu[5] = 0.5;  // on the spot: the mass wants out
  free.model.effects.front().theta = {0.2, 0.1, 0.0};
  model::Load load;
  load.clear();
  const model::ActiveEffect& effect = free.model.effects.front();
  effect.effect->load(motion, effect.theta, effect.variant, load);
  CHECK(load.wrench[0] == doctest::Approx(kMass * 0.2 * 0.25));
  CHECK(load.wrench[1] == doctest::Approx(kMass * 0.1 * 0.25));
  CHECK(load.wrench.tail<4>().norm() < kRounding);
}

TEST_CASE("centre_of_mass: left alone, the centre of mass goes straight on while the body tumbles about it") {
  const Free free;
  Trial trial;
  trial.dt = 0.1;
  trial.input_is_wrench = true;
  trial.observed = {true, false, true, true};  // the attitude follows from the rollout itself
  for (int k = 0; k <= 100; ++k) {
    trial.t.push_back(k * trial.dt);
    trial.p_WB.emplace_back(Eigen::Vector3d::Zero());
    trial.q_WB.push_back(Eigen::Quaterniond::Identity());
    trial.nu.emplace_back(Vector6d::Zero());
    trial.input.emplace_back(Vector6d::Zero());
  }
  Vector6d nu0;
  nu0 << 0.3, -0.1, 0.2, 0.2, -0.3, 0.6;
  model::VelocityTrace nu;
  REQUIRE(model::rollout(free.model, {&trial, 0, trial.size()}, nu0, nu));
  const auto of_centre = [&](Eigen::Index k) {
    return Eigen::Vector3d{nu.col(k).head<3>() + nu.col(k).tail<3>().cross(kArm)};
  };
  const auto energy = [&](Eigen::Index k) {
    const Eigen::Vector3d w = nu.col(k).tail<3>();
    return 0.5 * kMass * of_centre(k).squaredNorm() + 0.5 * w.dot(kInertia.cwiseProduct(w));
  };
  for (Eigen::Index k = 0; k < nu.cols(); ++k) {
    CHECK(std::abs(of_centre(k).norm() - of_centre(0).norm()) < kMidpoint);
    CHECK(energy(k) == doctest::Approx(energy(0)).epsilon(kMidpoint));
  }
  CHECK((nu.col(100) - nu.col(0)).norm() > 0.1);  // it did tumble
}

TEST_CASE("centre_of_mass: the mass matrix stays positive however far off the centre is") {
  Free free;
  model::Motion motion;
  motion.vehicle = &free.vehicle;
  motion.force = Vector6d::Zero();
  for (const double far : {0.1, 1.0, -20.0}) {
    model::Load load;
    const std::vector<double> place{far, -0.5 * far, far};
    free.model.effects.front().effect->load(motion, place, kAll, load);
    Matrix6d M = load.inertia();
    CHECK((M - M.transpose()).norm() < kRounding * M.norm());
    M.diagonal() += free.model.theta.head<6>();
    CHECK(Eigen::SelfAdjointEigenSolver<Matrix6d>{M}.eigenvalues().minCoeff() > 0.0);
  }
}

TEST_CASE(
    "centre_of_mass: asked for are the components that couple two simulated axes, of a vehicle whose mass is known") {
  const model::Effect& effect = *model::find_effect("centre_of_mass");
  model::Vehicle vehicle;
  vehicle.mass = kMass;
  vehicle.dof = {true, true, true, false, false, true};
  model::Scene scene{.vehicle = &vehicle, .attitude = true};
  scene.nu_rms.setConstant(0.3);
  const auto asked = [&] {
    const std::vector<std::string> names = effect.variants(scene);
    if (names.empty()) return std::string{"none"};
    CHECK(std::ranges::count(names, "-") + 1 == std::ssize(names));
    return names.back();
  };
  CHECK(asked() == "x_G, y_G, z_G");  // surge feels a measured pitch
  scene.nu_rms.segment<2>(3).setZero();
  CHECK(asked() == "x_G, y_G");
  CHECK(effect.variants(scene).size() == kHorizontal + 1);
  CHECK(effect.numbers(kHorizontal) == 2);
  vehicle.dof.fill(true);
  CHECK(asked() == "x_G, y_G");
  scene.nu_rms.setConstant(0.3);
  scene.nu_rms[5] = 0.0;
  vehicle.dof = {true, false, false, false, true, false};
  CHECK(asked() == "x_G, z_G");
  scene.nu_rms.tail<3>().setZero();
  CHECK(asked() == "none");
  scene.nu_rms.setConstant(0.3);
  CHECK(asked() == "x_G, y_G, z_G");
  scene.attitude = false;  // a tilt would look like z_G
  CHECK(asked() == "x_G, y_G");
  vehicle.mass = 0.0;
  CHECK(asked() == "none");
}

TEST_CASE("centre_of_mass: an axis that is only measured pushes the simulated ones as if it were simulated") {
  // All six axes fly; then two are told to a model that simulates the others: they must move as before.
  Free free;
  free.model.theta[model::index(model::BaseParameter::K_p)] = -0.2;
  free.model.theta[model::index(model::BaseParameter::M_q)] = -0.3;
  Trial trial;
  trial.dt = 0.02;
  trial.input_is_wrench = true;
  trial.observed = {true, false, true, true};
  for (int k = 0; k <= 400; ++k) {
    const double t = k * trial.dt;
    trial.t.push_back(t);
    trial.p_WB.emplace_back(Eigen::Vector3d::Zero());
    trial.q_WB.push_back(Eigen::Quaterniond::Identity());
    trial.nu.emplace_back(Vector6d::Zero());
    Vector6d wrench;
    wrench << 3.0 * std::sin(t), 2.0 * std::cos(2.0 * t), std::sin(3.0 * t), 0.2 * std::sin(2.5 * t),
        0.4 * std::cos(1.7 * t), 0.1 * std::sin(0.7 * t);
    trial.input.emplace_back(wrench);
  }
  model::VelocityTrace all, some;
  REQUIRE(model::rollout(free.model, {&trial, 0, trial.size()}, Vector6d::Zero(), all));
  for (std::size_t k = 0; k < trial.size(); ++k) trial.nu[k] = all.col(static_cast<Eigen::Index>(k));
  free.vehicle.dof[3] = free.vehicle.dof[4] = false;
  REQUIRE(model::rollout(free.model, {&trial, 0, trial.size()}, Vector6d::Zero(), some));
  CHECK((some - all).cwiseAbs().maxCoeff() < kMidpoint);
  CHECK(all.row(4).cwiseAbs().maxCoeff() > 0.1);
}
