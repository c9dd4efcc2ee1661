// Along what a learned force can act: shares of drag and thrust, streams, masses, pulls, against the way.
#include <doctest/doctest.h>

#include <cmath>

#include "common/model/dynamics.hpp"
#include "common/model/learned/factors/factor_kind.hpp"
#include "common/model/learned/learned_force.hpp"
#include "test/common/model/learned_bench.hpp"

using namespace fathom;
using namespace fathom::model;
using namespace fathom::test;

TEST_CASE("learned force: the hull's drag, all thrust and a thruster's line are directions of their own") {
  const Bench bench;
  Feature more = along(kHullDrag, {}), thrust = along(kAllThrust, {}), line = along(kThrusterLine + 2, {});
  FeatureState state{.tau = Vector6d::Constant(3.0), .drag = Vector6d::Constant(-2.0)};
  const Allocation B = bench.vehicle.allocation;
  state.allocation = &B;
  Vector6d wrench = Vector6d::Zero();
  more.add(state, 0.5, wrench);
  CHECK(wrench.isApprox(Vector6d::Constant(-1.0)));
  thrust.add(state, 1.0, wrench);
  CHECK(wrench.isApprox(Vector6d::Constant(2.0)));
  wrench.setZero();
  line.add(state, 4.0, wrench);
  CHECK(wrench.isApprox(4.0 * bench.vehicle.allocation.col(2)));
  CHECK(bench.made(one(more, -0.5)).force().reads_drag());
  // A share of the drag: within the model it makes the drag weaker or stronger.
  CHECK(bench.wrench(bench.made(one(more, 0.5)), Vector6d::Unit(0) * 0.3, Vector6d::Unit(0) * -8.0)[0] ==
        doctest::Approx(-4.0));
}

TEST_CASE("learned force: a law of all thrusters is that law for each, with its own force and fading") {
  const Bench bench;
  const Factor root{.quantity = Quantity::kThrusterRoot}, advance{.quantity = Quantity::kAdvance},
      knot{.quantity = Quantity::kThrustKnot, .a = 4.0, .b = 2.0, .c = 4.0};
  Motion motion{.nu = {0.2, -0.1, 0.05, 0.0, 0.0, 0.3}, .force = ActuatorForces{{1.0, -3.0, 5.0, 0.0, 30.0, -7.0}}};
  for (const auto& factors : {std::initializer_list<Factor>{knot}, std::initializer_list<Factor>{root, advance}}) {
    const Feature law = along(kEachThruster, factors, 0.5);
    Vector6d expected = Vector6d::Zero();
    Load load;
    for (int j = 0; j < 6; ++j) {
      const Feature one_of_them = law.of_own(j);
      CHECK(one_of_them.axis == kThrusterLine + j);
      load.clear();
      load.drag = Vector6d::Constant(-1e6);
      bench.made(one(one_of_them, 0.3)).load(motion, {}, 0, load);
      expected += load.wrench;
    }
    load.clear();
    load.drag = Vector6d::Constant(-1e6);
    bench.made(one(law, 0.3)).load(motion, {}, 0, load);
    CHECK(load.wrench.isApprox(expected, 1e-12));
    CHECK(expected.norm() > 0.01);
  }
  // A hat: 0 at 2 N, half at 3 N and 6 N, 1 at 4 N, 0 from 8 N on; odd.
  FeatureState state{.force = ActuatorForces{{2.0, -3.0, 4.0, 6.0, 8.0, 9.0}}};
  const double values[6]{0.0, -0.5, 1.0, 0.5, 0.0, 0.0};
  for (int j = 0; j < 6; ++j) CHECK(along(kEachThruster, {knot}).of_own(j).value(state) == doctest::Approx(values[j]));
  CHECK(along(kEachThruster, {root, advance}).words() == "|f_j|^(1/2) u_aj");
}

TEST_CASE("learned force: a stream moves the water, as a current does") {
  const Bench bench;
  Feature stream = along(kStream + 1, {}, 0.5);
  const LearnedForce learned = bench.made(one(stream, 0.4));  // 0.2 m/s toward east
  Model with = nominal_model(bench.vehicle, false), told = with;
  with.add({.effect = &learned});
  std::vector<double> theta(find_effect("current")->parameters().size(), 0.0);
  theta[1] = 0.2;
  told.add({.effect = find_effect("current"), .theta = theta});
  for (const double psi : {0.0, 1.0, 3.0}) {
    Motion a{.R_WB = Eigen::AngleAxisd(psi, Eigen::Vector3d::UnitZ()).toRotationMatrix(),
             .nu = {0.4, -0.2, 0.1, 0.0, 0.0, 0.3},
             .force = ActuatorForces::Zero(6)};
    a.vehicle = &bench.vehicle;
    Motion b = a;
    feel(with, a, {}, 0.0);
    feel(told, b, {}, 0.0);
    CHECK(a.v_WF_B.isApprox(b.v_WF_B, 1e-12));
    CHECK(acceleration(with, a).isApprox(acceleration(told, b), 1e-12));
  }
  CHECK(direction_symbol(kStream + 1) == "v_east =");
}

TEST_CASE("learned force: a craft that moves with water that swings gains speed as the water does") {
  const Bench bench;
  const Factor cosine{.quantity = Quantity::kToneCosine, .a = 1.5}, sine{.quantity = Quantity::kToneSine, .a = 1.5};
  FreeForce force;
  force.features = {along(kStream, {cosine}, 0.5), along(kStream + 2, {sine}, 0.5)};
  force.weights = {0.4, -0.3};
  force.groups = {{.kind = "swing", .axis = kStream, .first = 0, .count = 1, .closed = true},
                  {.kind = "swing", .axis = kStream + 2, .first = 1, .count = 1, .closed = true}};
  CHECK(swings(force));
  CHECK(as_it_stands(force, 9.0).weights == force.weights);
  const LearnedForce learned = bench.made(force);
  Model with = nominal_model(bench.vehicle, false);
  with.theta[index(BaseParameter::W_B)] = 0.0;
  with.add({.effect = &learned});
  constexpr double kStep = 1e-4;
  const auto water = [&](double t) { return force.stream({.t = t}).v_WF; };
  for (const double t : {0.3, 2.0, 40.0}) {
    Motion motion{.t = t, .force = ActuatorForces::Zero(6)};
    motion.vehicle = &bench.vehicle;
    motion.nu.head<3>() = water(t);
    feel(with, motion, {}, 0.0);
    CHECK(motion.v_WF_B.isApprox(water(t), 1e-12));
    const Eigen::Vector3d rate = (water(t + kStep) - water(t - kStep)) / (2.0 * kStep);
    CHECK((motion.a_WF_B - rate).norm() < 1e-6);  // to second order of the step
    const Vector6d nu_dot = acceleration(with, motion);
    CHECK((nu_dot.head<3>() - rate).norm() < 1e-6);
    CHECK(nu_dot.tail<3>().norm() < 1e-9);  // what is carried by water is not turned by it
  }
}

TEST_CASE("learned force: a mass is inertia without weight, as a load's is") {
  const Bench bench;
  const Factor moment{.quantity = Quantity::kAfter, .a = 3.0, .b = 0.3};
  const LearnedForce learned = bench.made(one(along(kMass, {moment}, 4.0), 0.75));
  const std::vector<double> theta{3.0, 0.0, 1.0};
  const Motion motion{.t = 9.0, .nu = {0.4, -0.2, 0.1, 0.05, -0.1, 0.3}, .force = ActuatorForces::Zero(6)};
  Load load, told;
  load.clear(), told.clear();
  learned.load(motion, {}, 0, load);
  find_effect("payload_change")->load(motion, theta, 0, told);
  CHECK(load.wrench.isApprox(told.wrench, 1e-12));
  CHECK(load.inertia().isApprox(told.inertia(), 1e-12));
  CHECK(load.inertia()(2, 2) == doctest::Approx(3.0));
}

TEST_CASE("learned force: a pull toward a point is that of a tether, slack up to its length") {
  Bench bench;
  bench.visited.p_low.setConstant(-4.0);
  bench.visited.p_high.setConstant(4.0);
  const Eigen::Vector3d anchor{3.0, -2.0, 0.5};
  const double slack = 1.5, stiffness = 4.0;
  const Factor stretch{.quantity = Quantity::kStretch, .a = anchor.x(), .b = anchor.y(), .c = anchor.z(), .d = slack};
  const LearnedForce learned = bench.made(one(along(kPull, {stretch}, 8.0), stiffness / 8.0));
  const std::vector<double> theta{stiffness, slack, anchor.x(), anchor.y(), anchor.z(), 0.0, 0.0, 0.0};
  const Eigen::Matrix3d R_WB = Eigen::AngleAxisd{0.7, Eigen::Vector3d{0.2, -0.3, 1.0}.normalized()}.toRotationMatrix();
  int taut = 0;
  for (const Eigen::Vector3d& p_WB : {Eigen::Vector3d{0.0, 0.0, 0.0}, {-3.0, 1.0, 2.0}, {2.5, -1.5, 0.0}, anchor}) {
    const Motion motion{.p_WB = p_WB, .R_WB = R_WB, .force = ActuatorForces::Zero(6)};
    Load load, told;
    load.clear(), told.clear();
    learned.load(motion, {}, 0, load);
    find_effect("tether_tension")->load(motion, theta, 0, told);
    CHECK(load.wrench.isApprox(told.wrench, 1e-12));
    if (told.wrench.norm() > 0.0) ++taut;
  }
  CHECK(taut == 2);
}

TEST_CASE("learned force: against the way, by length and speed, is the drag of a tether") {
  Bench bench;
  bench.visited.p_low.setConstant(-4.0);
  bench.visited.p_high.setConstant(4.0);
  bench.visited.nu.setConstant(1.0);
  const Factor length{.quantity = Quantity::kStretch, .a = 3.0, .b = -2.0, .c = 0.5};
  const LearnedForce learned =
      bench.made(one(along(kAgainstWay, {{.quantity = Quantity::kFlowSpeed}, length}, 2.0), 1.5));
  const std::vector<double> theta{3.0, 3.0, -2.0, 0.5, 0.0, 0.0, 0.0};
  const Motion motion{
      .p_WB = {-1.0, 1.0, 2.0}, .nu = {0.4, -0.3, 0.2, 0.1, 0.2, -0.3}, .force = ActuatorForces::Zero(6)};
  Load load, told;
  load.clear(), told.clear();
  learned.load(motion, {}, 0, load);
  find_effect("tether_drag")->load(motion, theta, 0, told);
  CHECK(told.wrench.norm() > 0.1);
  CHECK(load.wrench.isApprox(told.wrench, 1e-12));
}

TEST_CASE("learned force: what goes with the distance in the plan does not go with depth, and fades beyond the box") {
  Bench bench;
  bench.visited.p_low.setConstant(-2.0);
  bench.visited.p_high.setConstant(2.0);
  const Factor away{.quantity = Quantity::kPlanStretch, .a = 1.0, .b = -1.0, .d = 0.5};
  const LearnedForce learned = bench.made(one(along(kWorldAxis + 2, {away}, 1.0), 3.0));  // N/m
  const auto down_at = [&](const Eigen::Vector3d& p_WB) {
    Load load;
    load.clear();
    learned.load({.p_WB = p_WB, .force = ActuatorForces::Zero(6)}, {}, 0, load);
    return load.wrench[2];
  };
  CHECK(down_at({1.3, -1.0, 1.0}) == 0.0);  // within the length
  for (const double depth : {-1.0, 0.5, 2.0})
    CHECK(down_at({-1.0, 0.0, depth}) == doctest::Approx(3.0 * (std::hypot(2.0, 1.0) - 0.5)));
  CHECK(std::abs(down_at({60.0, 0.0, 0.0})) < 1e-3);
}
