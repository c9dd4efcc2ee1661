// Contacts: a bounce gives back less than it took, whatever the angle, and touches are counted.
#include "common/simulation/contact.hpp"

#include <doctest/doctest.h>

#include "common/simulation/body.hpp"
#include "test/support/dive_site.hpp"

using namespace fathom;
using namespace fathom::simulation;

namespace {

// Energy may rise by no more than this share of what a throw had at its start: the midpoint rule's own error.
constexpr double kIntegration = 1e-3;

// The LBV150 without drag and as heavy as its water: nothing but contacts takes energy.
model::Model frictionless(const model::Vehicle& vehicle) {
  model::Model model{.vehicle = &vehicle, .allocation = vehicle.allocation};
  model.theta.head<6>() << 9.75, 8.66, 10.9, 0.2, 0.5, 0.159;
  return model;
}

model::Vehicle whole() {
  model::Vehicle vehicle = test::vehicle_of_file("seabotix_lbv150");
  vehicle.dof.fill(true);
  return vehicle;
}

}  // namespace

TEST_CASE("contact: no throw against walls, floor or surface gains energy, and hard ones lose most") {
  const model::Vehicle vehicle = whole();
  const model::Site tank = test::site_of_file("tank");
  RandomStream random{1, "throws"};
  double lost = 0.0;
  constexpr int kThrows = 40;
  for (int k = 0; k < kThrows; ++k) {
    Body body{frictionless(vehicle),
              Hull{tank, vehicle.hull, 8.66, 107.9},
              {},
              {{0.0, 0.0, 0.75}, random.uniform(0.0, 6.0)},
              0,
              2500};
    // A push of half a second is the throw.
    model::ActuatorForces force(4);
    for (double& each : force) each = random.uniform(-13.0, 13.0);
    body.drive(force);
    for (int i = 0; i < 200; ++i) body.step();
    body.drive(model::ActuatorForces::Zero(4));
    double highest = body.energy();
    const double first = highest;
    for (int i = 0; i < 8000; ++i) {
      body.step();
      const double energy = body.energy();
      CHECK(energy < highest + kIntegration * first);
      highest = std::min(highest, energy);
      REQUIRE(body.at(body.now()).nu.allFinite());
    }
    lost += 1.0 - highest / first;
  }
  CHECK(lost / kThrows > 0.6);
}

TEST_CASE(
    "contact: driven against a wall it stays in the tank, nearly where the hull meets it, and one touch is counted") {
  auto simulator = test::make_simulator("seabotix_lbv150", "tank", {});
  Vector6d tau = Vector6d::Zero();
  tau[0] = 12.0;
  tau[2] = 1.2;  // holds the depth
  static_cast<void>(test::run<Truth>(*simulator, 12.0, tau));
  CHECK(simulator->contacts().walls >= 1);
  CHECK(simulator->contacts().walls <= 4);
  const Eigen::Vector3d p = simulator->moment().p_WB;
  CHECK(p.x() < 2.5 - 0.265 + 0.01);
  CHECK(p.x() > 2.5 - 0.265 - 0.2);  // it may have turned along the wall
}

TEST_CASE("contact: pressed against the floor it rests there") {
  auto simulator = test::make_simulator("seabotix_lbv150", "tank", {});
  Vector6d tau = Vector6d::Zero();
  tau[2] = 6.0;
  static_cast<void>(test::run<Truth>(*simulator, 20.0, tau));
  CHECK(simulator->contacts().floor >= 1);
  CHECK(std::abs(simulator->moment().p_WB.z() - (1.5 - 0.127)) < 2e-3);
  CHECK(simulator->moment().nu.norm() < 1e-3);
}
