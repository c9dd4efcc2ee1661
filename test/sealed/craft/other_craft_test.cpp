// Craft that are no ROVs: what the flow does to them takes energy, steers the right way and holds at the stall; the
// base model and their flow together explain their clean dives.
#include <doctest/doctest.h>

#include "test/sealed/craft/base_model.hpp"
#include "test/sealed/craft/flow.hpp"
#include "test/sealed/dives/other_writing.hpp"

namespace fathom::sealed {
namespace {

constexpr double kTimeStep = 0.005;      // s, that of the dives
constexpr double kRoundingOfFit = 1e-9;  // of a wrench: rounding of a least-squares solution
constexpr double kNumbers = 1e-4;
const Mechanisms kNothingHidden;
constexpr std::array kOthers{CraftClass::kTorpedo, CraftClass::kBoat, CraftClass::kShip, CraftClass::kGlider};

Craft craft_of(CraftClass craft_class, std::uint64_t seed = 3) {
  Random random(seed, "test");
  return draw_other_craft(craft_class, random);
}

Eigen::VectorXd idle(const Craft& craft) { return Eigen::VectorXd::Zero(static_cast<Eigen::Index>(craft.jets.size())); }

Site water_of(const Craft& craft) {
  Site site;
  site.half << 60.0, 60.0, 3.0;
  site.centre << 0.0, 0.0, craft.surfaced ? 0.0 : 9.0;
  return site;
}

Vector6 moving(const Craft& craft, Random& random) {
  Vector6 nu;
  for (int i = 0; i < 6; ++i) nu[i] = random.normal() * std::max(craft.pace[i], 0.05);
  if (craft.surfaced) nu.segment<3>(2).setZero();
  return nu;
}

}  // namespace

TEST_CASE("sealed craft: lift does no work, and stalled fins, hulls and strips only take energy") {
  Random random(1, "test");
  for (const CraftClass craft_class : kOthers) {
    const Craft craft = craft_of(craft_class);
    CAPTURE(craft.family);
    for (int k = 0; k < 200; ++k) {
      const Vector6 nu = moving(craft, random);
      const Vector6 drag = craft.hull.quadratic.cwiseProduct(nu.cwiseProduct(nu.cwiseAbs()));
      const Vector6 flow = flow_wrench(craft, idle(craft), nu);
      CHECK(nu.dot(flow - drag) < 0.0);
    }
  }
}

TEST_CASE("sealed craft: mechanical energy only falls without thrust") {
  for (const CraftClass craft_class : kOthers) {
    const Craft craft = craft_of(craft_class);
    CAPTURE(craft.family);
    Body body(craft, kNothingHidden);
    Commands commands;
    commands.force.assign(1, idle(craft));
    Random random(2, "test");
    State state = body.at_rest(water_of(craft).centre, 0.3);
    state.segment<6>(kSpeed) = moving(craft, random);
    double energy = body.energy(state);
    for (int i = 0; i < 2000; ++i) {
      body.step(0.0, kTimeStep, commands, state);
      const double now = body.energy(state);
      REQUIRE(now < energy + 1e-12 * std::max(std::abs(energy), 1.0));
      energy = now;
    }
  }
}

TEST_CASE(
    "sealed craft: a rudder that pushes the stern to starboard turns to port, a plane that pushes it down raises the "
    "bow") {
  const Craft craft = craft_of(CraftClass::kTorpedo);
  Vector6 nu = Vector6::Zero();
  nu[0] = craft.pace[0];
  const Vector6 straight = flow_wrench(craft, idle(craft), nu);
  for (const Eigen::Index fin : {1, 2}) {
    const Jet& jet = craft.jets[static_cast<std::size_t>(fin)];
    Eigen::VectorXd told = idle(craft);
    const auto full = [&](double share) -> Vector6 {
      told[fin] = share * jet.largest;
      return push_of(craft, acting_forces(craft, told, nu), Eigen::Vector3d::UnitZ()) + flow_wrench(craft, told, nu) -
             straight;
    };
    const Vector6 turned = full(1.0);
    CHECK(turned[fin] > 0.0);
    CHECK((fin == 1 ? -turned[5] : turned[4]) > 0.0);
    CHECK(turned[0] < 0.0);  // lift costs drag
    CHECK(turned[fin] == doctest::Approx(jet.largest * std::pow(nu[0] / jet.reference, 2)).epsilon(0.01));
    CHECK(full(9.0)[fin] == doctest::Approx(full(5.0)[fin]).epsilon(0.01));  // stalled
  }
}

TEST_CASE("sealed craft: a propeller gives less as it advances, and a rudder more in its wash") {
  const Craft craft = craft_of(CraftClass::kShip);
  Eigen::VectorXd told = idle(craft);
  told << craft.jets[0].largest, 0.5 * craft.jets[1].largest;
  Vector6 nu = Vector6::Zero();
  CHECK(acting_forces(craft, told, nu)[0] == doctest::Approx(told[0]));
  CHECK(acting_forces(craft, told, nu)[1] > 0.0);  // at rest in the wash alone
  nu[0] = craft.pace[0];
  CHECK(acting_forces(craft, told, nu)[0] < 0.8 * told[0]);
  const double washed = acting_forces(craft, told, nu)[1];
  told[0] = 0.0;
  CHECK(acting_forces(craft, told, nu)[1] < washed);
}

TEST_CASE("sealed craft: the base model and the craft's own flow explain clean dives, number by number") {
  for (const CraftClass craft_class : kOthers) {
    const Craft craft = craft_of(craft_class, 8);
    CAPTURE(craft.family);
    const std::vector<Dive> runs{dive(craft, water_of(craft), {}, {}, {.length = 120.0, .seed = 5, .purpose = "test"})};
    REQUIRE(runs.front().sound);
    const BaseFit fit = fit_base(craft, runs);
    for (std::size_t i = 0; i < 6; ++i) {
      const auto axis = static_cast<Eigen::Index>(i);
      if (craft.actuated[i]) CHECK(fit.residual[axis] <= kRoundingOfFit * fit.applied[axis]);
    }
    const Eigen::VectorXd truth = base_values(craft, craft.hull);
    for (Eigen::Index j = 0; j < truth.size(); ++j) {
      CAPTURE(base_names(craft)[static_cast<std::size_t>(j)]);
      CHECK(fit.values[j] == doctest::Approx(truth[j]).epsilon(kNumbers));
    }
  }
}

TEST_CASE("sealed craft: every class lists what may happen to it, and no ROV is drawn otherwise than before") {
  CHECK(catalogue_of(CraftClass::kRov).size() == catalogue().size());
  CHECK(foreign_of(CraftClass::kRov).size() == foreign().size());
  for (const CraftClass craft_class : kOthers) {
    CHECK(catalogue_of(craft_class).size() >= 9);
    CHECK(foreign_of(craft_class).size() >= 3);
  }
  CHECK(make_plan(7, {}).craft_class == CraftClass::kRov);
}

}  // namespace fathom::sealed
