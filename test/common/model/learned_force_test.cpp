#include "common/model/learned/learned_force.hpp"

#include <doctest/doctest.h>

#include <cmath>

#include "common/model/dynamics.hpp"
#include "common/model/learned/factors/factor_kind.hpp"
#include "test/common/model/learned_bench.hpp"

using namespace fathom;
using namespace fathom::model;
using namespace fathom::test;

TEST_CASE("learned force: it is its features within what was visited, and fades beyond") {
  const Bench bench;
  const LearnedForce force = bench.made(one(along(1, {kU, kU}, 2.0), -3.0));
  const Vector6d dissipating = Vector6d::Constant(-1e6);  // N: the limit of power is far
  CHECK(bench.wrench(force, Vector6d::Unit(0) * 0.4, dissipating)[1] == doctest::Approx(-3.0 * 2.0 * 0.16));
  const double edge = std::abs(bench.wrench(force, Vector6d::Unit(0) * 0.5, dissipating)[1]);
  double before = edge * kVisitedReach * kVisitedReach + 1e-12;
  for (const double u : {0.6, 0.8, 1.0, 2.0, 4.0}) {
    const double here = std::abs(bench.wrench(force, Vector6d::Unit(0) * u, dissipating)[1]);
    CHECK(here <= before);
    before = here;
  }
  CHECK(before < 1e-6 * edge);
}

TEST_CASE("learned force: a law in closed form is believed to twice what was visited, and that it was not is said") {
  const Bench bench;
  FreeForce law = one(along(1, {kU, kU}, 2.0), -3.0);
  law.groups.front().closed = true;
  CHECK(is_law(law));
  const LearnedForce force = bench.made(law);
  const Vector6d dissipating = Vector6d::Constant(-1e6);
  for (const double u : {0.4, 0.8, 0.5 * kLawReach})
    CHECK(bench.wrench(force, Vector6d::Unit(0) * u, dissipating)[1] == doctest::Approx(-6.0 * u * u));
  CHECK(std::abs(bench.wrench(force, Vector6d::Unit(0) * 4.0, dissipating)[1]) < 1e-3);
  CHECK_FALSE(force.beyond({.nu = Vector6d::Unit(0) * 0.5, .force = ActuatorForces::Zero(6)}));
  CHECK(force.beyond({.nu = Vector6d::Unit(0) * 0.8, .force = ActuatorForces::Zero(6)}));
  // Seven numbers are no law that can be read.
  FreeForce many;
  for (int j = 0; j < 7; ++j) many.features.push_back(along(1, {kU})), many.weights.push_back(0.1);
  many.groups = {{.kind = "test", .axis = 1, .count = 7, .closed = true}};
  CHECK_FALSE(is_law(many));
}

TEST_CASE("learned force: what goes with the velocity gives no more power than the drag takes") {
  const Bench bench;
  const LearnedForce force = bench.made(one(along(0, {kU}), 100.0));  // pushes where it moves to
  const Vector6d nu = Vector6d::Unit(0) * 0.3, drag = Vector6d::Unit(0) * -6.0;
  CHECK(bench.wrench(force, nu, drag)[0] == doctest::Approx(6.0));
  const LearnedForce brake = bench.made(one(along(0, {kU}), -100.0));
  CHECK(bench.wrench(brake, nu, drag)[0] == doctest::Approx(-30.0));
  // A force along the world moves with nothing: no limit.
  CHECK(bench.wrench(bench.made(one(along(kWorldAxis, {}), 5.0)), nu)[0] == doctest::Approx(5.0));
}

TEST_CASE("learned force: low passes settle, and follow as their time constants say") {
  const Bench bench;
  const int bank = 1;  // of the velocities
  const LearnedForce force =
      bench.made(one(along(0, {{.quantity = Quantity::kSlowVelocity, .index = 0, .bank = bank}}), 2.0));
  std::vector<double> z(static_cast<std::size_t>(force.state_size(bench.vehicle, 6)));
  Motion motion{.nu = Vector6d::Unit(0) * 0.2, .force = ActuatorForces::Zero(6)};
  force.settle(motion, {}, 0, z);
  force.feel(motion, {}, 0, z);
  CHECK(motion.w_memory[0] == doctest::Approx(0.4));
  motion.nu.setZero();
  for (int k = 0; k < 15; ++k) force.advance(motion, {}, 0, 0.1, z);
  motion.w_memory.setZero();
  force.feel(motion, {}, 0, z);
  CHECK(motion.w_memory[0] == doctest::Approx(0.4 * std::exp(-1.5 / kVelocityMemories[bank])));
  CHECK(force.run_in({}) >= 4.0 * kVelocityMemories[bank]);
}

TEST_CASE("learned force: what a thruster has done lately is looked up in its commands, and followed from there") {
  const Bench bench;
  const int bank = 1;
  const Factor f{.quantity = Quantity::kThruster, .index = 2},
      use{.quantity = Quantity::kRecentUse, .index = 2, .bank = bank};
  const LearnedForce force = bench.made(one(along(kThrusterLine + 2, {f, use}), -0.02));
  std::vector<double> z(static_cast<std::size_t>(force.state_size(bench.vehicle, 6)));
  // At rest for long, then 4 N astern for thirty seconds.
  const double dt = 0.1, pushed = 30.0, rested = 300.0;
  std::vector<Eigen::VectorXd> commands;
  for (double t = 0.0; t < rested + pushed; t += dt)
    commands.emplace_back(t < rested ? Eigen::VectorXd::Zero(6) : Eigen::VectorXd{-4.0 * Eigen::VectorXd::Unit(6, 2)});
  const InputSignal input{0.0, dt, commands};
  Motion motion{.t = rested + pushed, .force = -4.0 * Eigen::VectorXd::Unit(6, 2)};
  motion.input = &input;
  force.settle(motion, {}, 0, z);
  force.feel(motion, {}, 0, z);
  const auto after = [&](double seconds) { return 4.0 * -std::expm1(-seconds / kUseMemories[bank]); };
  const auto wrench = [&](double lately) { return Vector6d{0.02 * 4.0 * lately * bench.vehicle.allocation.col(2)}; };
  constexpr double kLookedUp = 0.05;  // commands are looked up at forty instants
  CHECK((motion.w_memory - wrench(after(pushed))).norm() < kLookedUp * wrench(after(pushed)).norm());
  for (int k = 0; k < 100; ++k) force.advance(motion, {}, 0, dt, z);
  motion.w_memory.setZero();
  force.feel(motion, {}, 0, z);
  CHECK((motion.w_memory - wrench(after(pushed + 10.0))).norm() < kLookedUp * wrench(after(pushed)).norm());
  // Before a record begins they have rested.
  const InputSignal begun{rested, dt, std::span{commands}.subspan(static_cast<std::size_t>(rested / dt))};
  motion.input = &begun;
  force.settle(motion, {}, 0, z);
  motion.w_memory.setZero();
  force.feel(motion, {}, 0, z);
  CHECK((motion.w_memory - wrench(after(pushed))).norm() < kLookedUp * wrench(after(pushed)).norm());
  // Where nobody knows what was commanded it is as if it had always been so.
  motion.input = nullptr;
  force.settle(motion, {}, 0, z);
  motion.w_memory.setZero();
  force.feel(motion, {}, 0, z);
  CHECK((motion.w_memory - wrench(4.0)).norm() < 1e-9);
}

TEST_CASE("learned force: what depends on time is not carried") {
  FreeForce force;
  force.features = {along(0, {kU, kV}), along(1, {{.quantity = Quantity::kAfter, .a = 3.0}}), along(2, {kV})};
  force.weights = {1.0, 2.0, 3.0};
  force.groups = {{.kind = "velocity", .axis = 0, .first = 0, .count = 1},
                  {.kind = "time", .axis = 1, .first = 1, .count = 1},
                  {.kind = "velocity", .axis = 2, .first = 2, .count = 1}};
  const FreeForce rest = without_time(force);
  REQUIRE(rest.groups.size() == 2);
  CHECK(rest.weights == std::vector<double>{1.0, 3.0});
  CHECK(rest.groups[1].first == 1);
}

TEST_CASE(
    "learned force: where the clock goes on, what has begun or grown stands as it stood, and tables are left out") {
  const Factor moment{.quantity = Quantity::kAfter, .a = 3.0}, ramp{.quantity = Quantity::kRamp, .a = 5.0, .b = 5.0};
  const Factor swing{.quantity = Quantity::kToneSine, .a = 2.0};
  FreeForce force;
  force.features = {along(0, {kU, moment}, 2.0), along(1, {ramp}), along(2, {moment}), along(0, {swing}),
                    along(3, {kV})};
  force.weights = {1.0, 2.0, 3.0, 4.0, 5.0};
  for (int j = 0; j < 5; ++j)
    force.groups.push_back({.kind = "test",
                            .axis = force.features[static_cast<std::size_t>(j)].axis,
                            .first = j,
                            .count = 1,
                            .closed = j != 2});
  const FreeForce rest = as_it_stands(force, 20.0);
  REQUIRE(rest.weights == std::vector<double>{1.0, 2.0, 4.0, 5.0});
  FeatureState state{.t = -7.0};  // whatever its clock shows
  state.nu[0] = 0.25;
  CHECK(rest.features[0].value(state) == doctest::Approx(2.0 * 0.25));
  CHECK(rest.features[1].value(state) == 1.0);                      // its end
  CHECK(rest.features[2].value(state) == std::sin(-14.0));          // in its phase
  CHECK(as_it_stands(force, 1.0).features[0].value(state) == 0.0);  // not begun yet
}

TEST_CASE("learned force: a ramp and a law's moment begin anew with a run, steps of a table are told of no other") {
  const Factor ramp{.quantity = Quantity::kRamp, .a = 5.0, .b = 5.0}, moment{.quantity = Quantity::kAfter, .a = 3.0};
  FreeForce force;
  force.features = {along(0, {ramp}), along(1, {moment}), along(2, {moment})};
  force.weights = {1.0, 2.0, 3.0};
  for (int j = 0; j < 3; ++j)
    force.groups.push_back({.kind = "test", .axis = j, .first = j, .count = 1, .closed = j < 2});
  const FreeForce rest = lasting_of(force);
  REQUIRE(rest.weights == std::vector<double>{1.0, 2.0});
  FeatureState state{.t = 7.0};
  CHECK(rest.features[0].value(state) == doctest::Approx(0.4));
  CHECK(rest.features[1].value(state) == 1.0);
  state.t = 1.0;
  CHECK(rest.features[1].value(state) == 0.0);  // not yet, on that run's clock
  state.t = 1000.0;
  CHECK(rest.features[0].value(state) == 1.0);  // where its recording ended
}

TEST_CASE("factors: every kind has a name of its own, words and a value") {
  FeatureState state{.t = 2.0,
                     .p_WB = {0.1, 0.2, 0.3},
                     .nu = Vector6d::Constant(0.4),
                     .tau = Vector6d::Constant(5.0),
                     .force = ActuatorForces::Constant(6, 2.0)};
  for (auto& slow : state.slow_tau) slow.setOnes();
  for (auto& slow : state.slow_nu) slow.setOnes();
  Visited visited = Bench{}.visited;
  visited.p_low.setConstant(-1.0);
  visited.p_high.setConstant(1.0);
#define FACTOR(enumerator, name)                                                  \
  {                                                                               \
    const FactorKind& kind = kind_of(Quantity::enumerator);                       \
    CAPTURE(kind.word);                                                           \
    const Factor factor{.quantity = Quantity::enumerator, .index = 1, .a = 1.5};  \
    CHECK(quantity_from(kind.word) == Quantity::enumerator);                      \
    CHECK(!kind.sentence.empty());                                                \
    CHECK(!kind.unit.empty());                                                    \
    CHECK(!kind.words(factor).empty());                                           \
    CHECK(std::isfinite(kind.value(factor, state)));                              \
    if (kind.within != nullptr) CHECK(kind.within(factor, state, visited) > 0.0); \
  }
#include "common/model/learned/factors/factors.def"
#undef FACTOR
  CHECK_FALSE(quantity_from("no such thing"));
}

TEST_CASE("factors: a voltage that was not logged, or is its mean, changes nothing, and fades where it never was") {
  const Factor voltage{.quantity = Quantity::kVoltage, .a = 16.0, .b = 0.05, .c = 0.1};
  const FactorKind& kind = kind_of(Quantity::kVoltage);
  const Visited visited;
  FeatureState state;
  CHECK(kind.value(voltage, state) == 0.0);
  CHECK(kind.within(voltage, state, visited) == 1.0);
  state.voltage = 16.0;
  CHECK(kind.value(voltage, state) == 0.0);
  state.voltage = 16.0 * 1.05;
  CHECK(kind.value(voltage, state) == doctest::Approx(1.0));
  CHECK(kind.within(voltage, state, visited) == 1.0);
  state.voltage = 16.0 * 1.19;
  CHECK(kind.within(voltage, state, visited) == 1.0);  // a law is believed as far again
  state.voltage = 4.0;
  CHECK(kind.within(voltage, state, visited) < 1e-3);
}

TEST_CASE("factors: what settles begins at nothing, slows down, and goes on with its clock as far as it is believed") {
  const Factor settling{.quantity = Quantity::kSettling, .a = 10.0, .b = 20.0, .c = 50.0};
  const FactorKind& kind = kind_of(Quantity::kSettling);
  const auto at = [&](double t) { return kind.value(settling, FeatureState{.t = t}); };
  CHECK(at(0.0) == 0.0);
  CHECK(at(30.0) == doctest::Approx(1.0 - std::exp(-1.0)));
  CHECK(at(50.0) == doctest::Approx(1.0 - std::exp(-2.0)));
  CHECK(at(1e6) == at(50.0));
  CHECK(kind.words(settling) == "(1 - exp(-(t - 10 s) / 20 s))");
  CHECK(kind.words({.quantity = Quantity::kSettling, .b = 20.0}) == "(1 - exp(-t / 20 s))");
  FreeForce force;
  force.features = {along(0, {settling})};
  force.weights = {2.0};
  force.groups = {{.kind = "test", .axis = 0, .first = 0, .count = 1, .closed = true}};
  CHECK(lasting_of(force).weights == force.weights);  // of its own run, like a ramp
  const FreeForce later = as_it_stands(force, 50.0);
  REQUIRE(later.features.size() == 1);
  CHECK(later.features.front().value({.t = 30.0}) == doctest::Approx(at(30.0)));  // on the clock that goes on
}

TEST_CASE("factors: nearness is 1 at an edge, falls by e per reach, doubles beyond, and fades a reach away") {
  FeatureState state;
  state.p_WB = {3.0, 4.0, 1.5};
  const Visited visited;
  const double bearing = std::atan2(4.0, 3.0);
  struct Case {
    Factor factor;
    double beyond;  // m
  };
  for (const Case& one : {Case{{.quantity = Quantity::kNear, .index = 0, .a = 5.0, .b = 0.5, .c = bearing}, 0.0},
                          Case{{.quantity = Quantity::kNear, .index = 0, .a = 6.0, .b = 0.5, .c = bearing}, -1.0},
                          Case{{.quantity = Quantity::kNear, .index = 1, .a = 2.0, .b = 0.5}, -0.5},
                          Case{{.quantity = Quantity::kNear, .index = 2, .a = -1.0, .b = 0.5}, -0.5},
                          Case{{.quantity = Quantity::kNear, .index = 2, .a = -1.6, .b = 0.5}, 0.1},
                          Case{{.quantity = Quantity::kNear, .index = 2, .a = -2.0, .b = 0.5}, 0.5},
                          Case{{.quantity = Quantity::kNear, .index = 2, .a = -3.5, .b = 0.5}, 2.0}}) {
    const FactorKind& kind = kind_of(Quantity::kNear);
    CHECK(kind.value(one.factor, state) == doctest::Approx(std::min(std::exp(one.beyond / 0.5), kLawReach)));
    const double left = kind.within(one.factor, state, visited);
    CHECK((one.beyond <= 0.5 ? left == 1.0 : left < 0.5));
  }
}
