// Effects of hull, payload and water, against hand-written formulas, steady states and energy.
#include <doctest/doctest.h>

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <random>

#include "common/model/dynamics.hpp"
#include "common/model/rollout.hpp"
#include "test/support/virtual_dive.hpp"

using namespace fathom;

namespace {

constexpr double kHullRounding = 1e-12;
constexpr double kHullMidpoint = 2e-3;  // of the largest speed: midpoint steps of 50 ms against an exact solution
using model::BaseParameter;

/// No drag, no weight, masses of 20 kg and 1 kg m^2: what happens is the effect's doing.
struct Bare {
  explicit Bare(std::array<bool, 6> dof) {
    vehicle.name = "bare";
    vehicle.dof = dof;
    vehicle.mass = 10.0;
    model = model::nominal_model(vehicle, true);
    model.theta.setZero();
    model.theta.head<6>() << 20, 20, 20, 1, 1, 1;
  }
  [[nodiscard]] Trial run(double duration, const std::function<Vector6d(double)>& wrench) const {
    Trial trial;
    trial.dt = 0.1;
    trial.input_is_wrench = true;
    trial.observed = {true, true, true, true};
    for (std::size_t k = 0; k <= static_cast<std::size_t>(std::lround(duration / trial.dt)); ++k) {
      trial.t.push_back(static_cast<double>(k) * trial.dt);
      trial.p_WB.emplace_back(0, 0, 1);
      trial.q_WB.push_back(Eigen::Quaterniond::Identity());
      trial.nu.emplace_back(Vector6d::Zero());
      trial.input.emplace_back(wrench(trial.t.back()));
    }
    return trial;
  }
  [[nodiscard]] model::VelocityTrace rollout(const Trial& trial) const {
    model::VelocityTrace nu;
    REQUIRE(model::rollout(model, {&trial, 0, trial.size()}, Vector6d::Zero(), nu));
    return nu;
  }

  model::Vehicle vehicle;
  model::Model model;
};

Vector6d along(int axis, double value) { return value * Vector6d::Unit(axis); }

}  // namespace

TEST_CASE("cubic_drag: constant thrust ends at the cube root") {
  Bare bare{{true, false, false, false, false, false}};
  bare.model.add(test::active("cubic_drag", {64.0}, 0));
  const model::VelocityTrace nu = bare.rollout(bare.run(20.0, [](double) { return along(0, 8.0); }));
  CHECK(nu(0, nu.cols() - 1) == doctest::Approx(0.5).epsilon(kHullMidpoint));
}

TEST_CASE("asymmetric_drag: all of the drag larger astern is its linear and its quadratic form together") {
  constexpr int kSwayQuadratic = 1, kSwayLinear = 4, kSwayBoth = 7;
  constexpr double kMore = 0.3, kDamping = 8.0, kQuadratic = 17.0;  // going to port: of Y_v, Y_v|v|
  const model::Effect& effect = *model::find_effect("asymmetric_drag");
  CHECK(effect.numbers(kSwayQuadratic) == 1);
  CHECK(effect.numbers(kSwayLinear) == 1);
  CHECK(effect.numbers(kSwayBoth) == 2);
  const std::vector<double> theta{0.5 * kMore * kQuadratic, 0.5 * kMore * kDamping};
  for (const double v : {-0.6, -0.1, 0.2, 0.5}) {
    model::Motion motion;
    motion.nu[1] = v;
    model::Load both, quadratic, linear;
    effect.load(motion, theta, kSwayBoth, both);
    effect.load(motion, theta, kSwayQuadratic, quadratic);
    effect.load(motion, theta, kSwayLinear, linear);
    const double odd = -(1.0 + 0.5 * kMore) * (kDamping + kQuadratic * std::abs(v)) * v;
    const double share = v < 0.0 ? 1.0 + kMore : 1.0;
    CHECK(odd + both.wrench[1] == doctest::Approx(-share * (kDamping + kQuadratic * std::abs(v)) * v));
    CHECK((both.wrench - quadratic.wrench - linear.wrench).norm() < 1e-12);
    CHECK(both.wrench.norm() == std::abs(both.wrench[1]));
  }
}

TEST_CASE("restoring_moment: the same motion as with those components in the base model") {
  Bare bare{{true, true, true, true, true, true}};
  model::Motion motion;
  motion.vehicle = &bare.vehicle;
  motion.force = Vector6d::Zero();
  motion.R_WB = rotation_from_euler({0.3, -0.2, 1.0});
  const Eigen::Vector3d down = motion.R_WB.transpose() * Eigen::Vector3d::UnitZ();
  const std::vector G{2.0, -1.0, 3.0};
  for (int asked = 1; asked < 8; ++asked) {
    model::Load load;
    model::find_effect("restoring_moment")->load(motion, G, asked, load);
    model::Model base = bare.model;
    Eigen::Vector3d moment = Eigen::Vector3d::Zero();
    for (int component = 0; component < 3; ++component) {
      if ((asked >> component & 1) == 0) continue;
      const double size = G[static_cast<std::size_t>(component)];
      moment += (size * Eigen::Vector3d::Unit(component)).cross(down);
      base.theta[model::index(BaseParameter::G_x) + component] = size;
    }
    CHECK((load.wrench.tail<3>() - moment).norm() < kHullRounding);
    CHECK(load.wrench.head<3>().isZero(0.0));
    CHECK((model::acceleration(base, motion).tail<3>() - moment).norm() < kHullRounding);
  }
}

/// One form of that name, in which just these components take part.
void check_asked(const model::Effect& effect, const model::Scene& scene, const std::string& name,
                 const std::array<bool, 3>& components) {
  const std::vector<std::string> forms = effect.variants(scene);
  CHECK(std::ranges::count(forms, "-") + 1 == std::ssize(forms));
  REQUIRE(forms.back() == name);
  const int form = static_cast<int>(forms.size()) - 1;
  for (std::size_t i = 0; i < 3; ++i) CHECK(effect.takes_part(form, i) == components[i]);
  CHECK(effect.numbers(form) == std::ranges::count(components, true));
}

TEST_CASE("restoring_moment: asked for only where the base model does not have it and something feels it") {
  model::Vehicle vehicle = test::vehicle_from_repository("bluerov2");  // roll is free, pitch is not
  model::Scene scene{.vehicle = &vehicle};
  const model::Effect& effect = *model::find_effect("restoring_moment");
  CHECK(effect.variants(scene).empty());
  scene.tilt_rms = 0.1;  // then G_x turns the bow
  check_asked(effect, scene, "G_x", {true, false, false});
  vehicle.parameters = {"m_X"};
  scene.tilt_rms = 0.0;
  check_asked(effect, scene, "G_y, G_z", {false, true, true});
}

TEST_CASE("compressibility: stiffer than water, a vehicle swings about its neutral depth") {
  Bare bare{{false, false, true, false, false, false}};
  bare.model.add(test::active("compressibility", {-5.0}));                   // sqrt(5 / 20) = 0.5 rad/s
  const Trial trial = bare.run(20.0, [](double) { return along(2, 0.0); });  // starts 1 m deep
  const model::VelocityTrace nu = bare.rollout(trial);
  for (Eigen::Index k = 0; k < nu.cols(); ++k) {
    CHECK(std::abs(nu(2, k) + 0.5 * std::sin(0.5 * trial.t[static_cast<std::size_t>(k)])) < kHullMidpoint);
  }
}

TEST_CASE("payload_change: heavier after its moment, and sinking by its weight") {
  Bare bare{{true, false, true, false, false, false}};
  bare.model.add(test::active("payload_change", {5.0, 2.5, 10.0}));
  const model::VelocityTrace nu = bare.rollout(bare.run(20.0, [](double) { return along(0, 10.0); }));
  const auto slope = [&](int axis, Eigen::Index k) { return (nu(axis, k + 10) - nu(axis, k)) / 1.0; };
  CHECK(slope(0, 50) == doctest::Approx(10.0 / 20.0));
  CHECK(slope(2, 50) == doctest::Approx(0.0));
  CHECK(slope(0, 150) == doctest::Approx(10.0 / 25.0));
  CHECK(slope(2, 150) == doctest::Approx(2.5 / 25.0));
}

TEST_CASE("payload_change, cross_coupling, centre_of_mass: what mass adds does no work") {
  std::mt19937 random{3};
  std::normal_distribution<double> normal;
  Bare bare{{true, true, true, true, true, true}};
  const auto names =
      model::find_effect("cross_coupling")->variants({.vehicle = &bare.vehicle, .nu_rms = Vector6d::Ones()});
  std::vector<model::ActiveEffect> heavy{test::active("payload_change", {4.0, 0.0, 0.0}),
                                         test::active("centre_of_mass", {0.1, 0.2, -0.1}, 7)};
  for (std::size_t v = 0; v < names.size(); ++v) {
    if (names[v].ends_with("_dot")) heavy.push_back(test::active("cross_coupling", {0.6}, static_cast<int>(v)));
  }
  REQUIRE(heavy.size() == 17);
  for (const model::ActiveEffect& effect : heavy) {
    model::Model model = bare.model;
    model.theta.head<6>() << 20, 25, 30, 1, 2, 3;
    model.add(effect);
    for (int i = 0; i < 20; ++i) {
      model::Motion motion{.t = 5.0};
      motion.vehicle = &bare.vehicle;
      motion.force = Vector6d::Zero();
      for (int axis = 0; axis < 6; ++axis) motion.nu[axis] = normal(random);
      model::Load load;
      (void)model::generalised_force(model, motion, load);
      Matrix6d M = load.inertia();
      M.diagonal() += model.theta.head<6>();
      CHECK(std::abs(motion.nu.dot(M * model::acceleration(model, motion))) < 1e-9);
    }
  }
}

TEST_CASE("cross_coupling: covers every pair that a symmetric hull has, and what one side carries") {
  const model::Vehicle beluga = test::vehicle_from_repository("beluga");
  const auto names = model::find_effect("cross_coupling")->variants({.vehicle = &beluga, .nu_rms = Vector6d::Ones()});
  for (const char* wanted : {"Y_r", "N_v", "Y_r|r|", "N_v|v|", "Y_r_dot", "X_q_dot", "M_u", "Z_q|q|", "K_v", "K_r_dot",
                             "N_u|u|", "Y_u", "K_w", "X_r_dot", "X_v_dot", "Z_p_dot"}) {
    CAPTURE(wanted);
    CHECK(std::count(names.begin(), names.end(), wanted) == 1);
  }
}

TEST_CASE("fluid_memory: the memory is exact for constant motion, whatever the step") {
  const model::Effect& effect = *model::find_effect("fluid_memory");
  const std::vector<double> theta{99.0, 10.0, 0.0, 0.0, 0.0, 0.0, 2.0, 0.0};
  const model::Vehicle vehicle = test::vehicle_from_repository("seabotix_lbv150");
  model::Motion motion;
  motion.vehicle = &vehicle;
  for (const double dt : {0.01, 0.5, 7.0}) {
    std::vector<double> z(static_cast<std::size_t>(effect.state_size(vehicle, 4)), 0.0);
    motion.nu.setZero();
    effect.settle(motion, theta, 0, z);
    motion.nu.setConstant(1.0);
    effect.advance(motion, theta, 0, 1e-12, z);  // the step of velocity happens at once
    double elapsed = 0.0;
    for (int i = 0; i < 10; ++i) {
      effect.advance(motion, theta, 0, dt, z);
      elapsed += dt;
      CHECK(z[0] == doctest::Approx(-std::expm1(-elapsed / 2.0)).epsilon(1e-9));
    }
    model::Motion felt = motion;
    effect.feel(felt, theta, 1, z);
    CHECK(felt.w_memory[1] == doctest::Approx(-10.0 * z[1]));
    CHECK(felt.w_memory[0] == 0.0);
  }
}

TEST_CASE("fluid_memory: on all axes that move each has its own strength") {
  const model::Effect& effect = *model::find_effect("fluid_memory");
  model::Vehicle vehicle;
  vehicle.dof = {true, false, true, false, false, true};
  const auto names = effect.variants({.vehicle = &vehicle});
  const auto all = std::ranges::find(names, "all axes");
  REQUIRE(all != names.end());
  const auto variant = static_cast<int>(all - names.begin());
  CHECK(effect.numbers(variant) == 4);
  CHECK(effect.numbers(2) == 2);
  model::Motion motion;
  motion.vehicle = &vehicle;
  motion.nu.setConstant(0.7);
  std::vector<double> z(static_cast<std::size_t>(effect.state_size(vehicle, 6)), 0.0);
  const std::vector<double> theta{10.0, 5.0, 30.0, 5.0, 5.0, 1.0, 2.0, 0.0};
  effect.settle(motion, theta, 0, z);
  effect.feel(motion, theta, variant, z);
  CHECK((motion.w_memory + 0.7 * Vector6d{10.0, 0.0, 30.0, 0.0, 0.0, 1.0}).norm() < 1e-12);

  vehicle.dof = {true, false, false, false, false, false};
  CHECK_FALSE(std::ranges::count(effect.variants({.vehicle = &vehicle}), "all axes") > 0);  // one axis: its own form
}

TEST_CASE("fluid_memory: swinging, it is the motion folded with exp(-t/T) cos(omega t) / T, whatever the step") {
  const model::Effect& effect = *model::find_effect("fluid_memory");
  const model::Vehicle vehicle = test::vehicle_from_repository("seabotix_lbv150");
  const auto names = effect.variants({.vehicle = &vehicle});
  const auto form = std::ranges::find(names, "v, swinging");
  REQUIRE(form != names.end());
  const auto variant = static_cast<int>(form - names.begin());
  CHECK(effect.numbers(variant) == 3);
  CHECK(effect.rules_out(variant, 1));
  CHECK_FALSE(effect.rules_out(variant, 0));
  constexpr double kT = 1.7, kOmega = 1.3, kK = 10.0;
  const std::vector<double> theta{99.0, kK, 0.0, 0.0, 0.0, 0.0, kT, kOmega};
  model::Motion motion;
  motion.vehicle = &vehicle;
  // At rest, then one m/s for good: the integral of the kernel from 0 to t.
  const auto folded = [&](double t) {
    const double a = 1.0 / kT, e = std::exp(-a * t);
    const double whole = a / (a * a + kOmega * kOmega);
    return a * (whole + e * (kOmega * std::sin(kOmega * t) - a * std::cos(kOmega * t)) / (a * a + kOmega * kOmega));
  };
  for (const double dt : {0.01, 0.4, 3.0}) {
    std::vector<double> z(static_cast<std::size_t>(effect.state_size(vehicle, 4)), 0.0);
    motion.nu.setZero();
    effect.settle(motion, theta, variant, z);
    motion.nu.setConstant(1.0);
    effect.advance(motion, theta, variant, 1e-12, z);  // the step of velocity happens at once
    for (int i = 1; i <= 10; ++i) {
      effect.advance(motion, theta, variant, dt, z);
      CHECK(z[1] == doctest::Approx(folded(i * dt)).epsilon(1e-9));
    }
    std::vector<double> settled(z.size(), 0.0);
    effect.settle(motion, theta, variant, settled);
    CHECK(settled[1] == doctest::Approx(folded(1e3)).epsilon(1e-9));
    model::Motion felt = motion;
    effect.feel(felt, theta, variant, z);
    CHECK(felt.w_memory[1] == doctest::Approx(-kK * z[1]));
    CHECK(felt.w_memory[0] == 0.0);
  }
}

TEST_CASE("fluid_memory: follows a sine late and smaller, and takes energy") {
  // In a rollout: m u_dot = tau - k z. For u = sin(w t): z lags by atan(w T) and shrinks by 1 / sqrt(1 + w^2 T^2).
  constexpr double kOmega = 1.0, kT = 2.0, kK = 10.0;
  Bare bare{{true, false, false, false, false, false}};
  bare.model.add(test::active("fluid_memory", {kK, 0.0, 0.0, 0.0, 0.0, 0.0, kT, 0.0}, 0));
  const double gain = 1.0 / std::sqrt(1.0 + kOmega * kOmega * kT * kT), late = std::atan(kOmega * kT);
  const Trial trial = bare.run(60.0, [&](double t) {
    return along(0, 20.0 * kOmega * std::cos(kOmega * t) + kK * gain * std::sin(kOmega * t - late));
  });
  const model::VelocityTrace nu = bare.rollout(trial);
  // What the start leaves dies out at the rate of the memory's poles: 20 s^2 + 10 s + 5.
  constexpr double kSmall = 0.01;
  double mean = 0.0;
  for (Eigen::Index k = 400; k < nu.cols(); ++k)
    mean += nu(0, k) - std::sin(kOmega * trial.t[static_cast<std::size_t>(k)]);
  mean /= static_cast<double>(nu.cols() - 400);
  for (Eigen::Index k = 400; k < nu.cols(); ++k) {
    CHECK(std::abs(nu(0, k) - mean - std::sin(kOmega * trial.t[static_cast<std::size_t>(k)])) < kSmall);
  }
  CHECK(gain * std::cos(late) > 0.0);  // the force's share in phase with the velocity: it brakes
}

TEST_CASE("fluid_memory, cubic_drag, tether_drag, drag of boundaries: none feeds the motion") {
  std::mt19937 random{5};
  std::normal_distribution<double> normal;
  model::Motion motion;
  motion.force = Vector6d::Zero();
  for (int i = 0; i < 50; ++i) {
    for (int axis = 0; axis < 6; ++axis) motion.nu[axis] = normal(random);
    motion.R_WB = rotation_from_euler({0.2 * normal(random), 0.2 * normal(random), normal(random)});
    motion.p_WB = Eigen::Vector3d{normal(random), normal(random), normal(random)};
    model::Load load;
    load.drag = -2.0 * motion.nu;
    for (int axis = 0; axis < 6; ++axis) model::find_effect("cubic_drag")->load(motion, std::vector{3.0}, axis, load);
    model::find_effect("tether_drag")->load(motion, std::vector{3.0, 1.0, 2.0, 3.0}, 0, load);
    model::find_effect("tether_drag")->load(motion, std::vector{3.0, 1.0, 2.0, 3.0, -0.4, 0.1, -0.2}, 7, load);
    model::find_effect("bottom_effect")->load(motion, std::vector{3.0, 4.0}, 1, load);
    model::find_effect("wall_effect")->load(motion, std::vector{3.0, 0.4, 5.0}, 1, load);
    CHECK(load.wrench.dot(motion.nu) < 0.0);
  }
}

TEST_CASE(
    "appendage: drags by its own velocity past the water, turns the vehicle by its arm, and takes energy always") {
  constexpr int kBlunt = 7, kWider = 15;
  const auto load_of = [](int variant, const Vector6d& nu) {
    model::Motion motion;
    motion.nu = nu;
    model::Load load;
    model::find_effect("appendage")
        ->load(motion,
               std::vector{6.0, variant == kBlunt ? 0.0 : std::log(2.5), variant == kBlunt ? 0.0 : std::log(0.5), 0.5,
                           0.0, -0.2},
               variant, load);
    return load.wrench;
  };
  // Turning on the spot: v_C = r x_C along y, and the moment x_C F_y about z, -z_C F_y about x.
  const Vector6d turning = load_of(kBlunt, (Vector6d() << 0, 0, 0, 0, 0, 0.8).finished());
  CHECK((turning - (Vector6d() << 0, -0.96, 0, -0.192, 0, -0.48).finished()).norm() < kHullRounding);
  // Wider across y, narrower across z.
  const auto straight = [](int axis) { return Vector6d{0.4 * Vector6d::Unit(axis)}; };
  for (int axis = 0; axis < 3; ++axis) {
    const double share = axis == 1 ? 2.5 : axis == 2 ? 0.5 : 1.0;
    CHECK((load_of(kWider, straight(axis)) - share * load_of(kBlunt, straight(axis))).norm() < kHullRounding);
  }
  CHECK(load_of(kWider, straight(1))[5] == doctest::Approx(0.5 * -2.4));
  std::mt19937_64 random{7};
  std::normal_distribution<double> normal;
  for (int k = 0; k < 200; ++k) {
    const Vector6d nu = Vector6d::NullaryExpr([&] { return normal(random); });
    CHECK(load_of(kBlunt, nu).dot(nu) < 0.0);
    CHECK(load_of(kWider, nu).dot(nu) < 0.0);
  }
}

TEST_CASE("appendage: sought along the axes in which it turns the vehicle, and of no craft that lives by its flow") {
  const model::Effect& appendage = *model::find_effect("appendage");
  const auto asked = [&](const char* name, double sway = 0.0) {
    const model::Vehicle vehicle = test::vehicle_from_repository(name);
    model::Scene scene{.vehicle = &vehicle, .position = true, .attitude = true, .velocity = true, .rates = true};
    scene.nu_rms << 0.3, 0.3, 0.3, sway, sway, 0.3;
    scene.tau_rms.setConstant(5.0);
    std::vector<int> numbers;
    const auto names = appendage.variants(scene);
    for (std::size_t v = 0; v < names.size(); ++v) {
      if (names[v] == "-") continue;
      numbers.push_back(appendage.numbers(static_cast<int>(v)));
      for (const auto& start : appendage.starts(scene, static_cast<int>(v))) CHECK(start.size() == 6);
    }
    return numbers;
  };
  CHECK(asked("bluerov2_heavy") == std::vector{4, 6});
  CHECK(asked("seabotix_lbv150") == std::vector{3, 5});  // it neither rolls nor pitches: no height is felt
  CHECK(asked("seabotix_lbv150", 0.1) == std::vector{4, 6});
  CHECK(asked("kvlcc2_l3").empty());
}
