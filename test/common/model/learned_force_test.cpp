#include "common/model/learned/learned_force.hpp"

#include <doctest/doctest.h>

#include "common/model/dynamics.hpp"
#include "test/support/virtual_dive.hpp"

using namespace fathom;
using namespace fathom::model;

namespace {

FreeForce one(const Feature& feature, double weight) {
  return {.features = {feature}, .groups = {{.kind = "test", .axis = feature.axis, .count = 1}}, .weights = {weight}};
}

Feature along(int axis, std::initializer_list<Factor> factors, double scale = 1.0) {
  Feature feature{.axis = axis, .count = static_cast<int>(factors.size()), .scale = scale};
  std::ranges::copy(factors, feature.factors.begin());
  return feature;
}

const Factor kU{.quantity = Quantity::kVelocity, .index = 0}, kV{.quantity = Quantity::kVelocity, .index = 1};

struct Bench {
  Vehicle vehicle = test::vehicle_from_repository("bluerov2");
  Visited visited{
      .nu = Vector6d::Constant(0.5), .tau = Vector6d::Constant(20.0), .force = ActuatorForces::Constant(6, 10.0)};

  Vector6d wrench(const LearnedForce& force, const Vector6d& nu, const Vector6d& drag = Vector6d::Zero()) const {
    Motion motion{.nu = nu, .force = ActuatorForces::Zero(6)};
    Load load;
    load.clear();
    load.drag = drag;
    force.load(motion, {}, 0, load);
    return load.wrench;
  }
  LearnedForce made(const FreeForce& force) const { return {force, visited, vehicle.allocation}; }
};

}  // namespace

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
