// Torpedoes, twin-thruster boats, ships and gliders by the rules of thumb of textbooks: slender-body added masses and
// low-aspect lift (Fossen 2021; Prestero 2001; Inoue 1981; Graver 2005), strips for cross-flow drag.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "test/sealed/craft/flow.hpp"

namespace fathom::sealed {
namespace {

using Eigen::Vector3d;

constexpr double kPi = std::numbers::pi;
constexpr int kStrips = 12;

/// N at rest of a propeller that drives a craft of drag c u^2 at `speed` [m/s].
double thrust_for(const Craft& craft, const Jet& propeller, double drag, double speed) {
  const double a = craft.density * std::pow(propeller.diameter, 4) * propeller.thrust_0;
  const double b = -craft.density * std::pow(propeller.diameter, 3) * propeller.thrust_1;
  const double turns = speed * (b + std::sqrt(b * b + 4.0 * a * drag)) / (2.0 * a);
  return a * turns * turns;
}

Jet propeller_at(const Vector3d& position, double diameter, Random& random) {
  Jet jet{.position = position, .axis = Vector3d::UnitX(), .drive = Drive::kPropeller, .diameter = diameter};
  jet.thrust_0 = random.uniform(0.22, 0.38);
  jet.thrust_1 = -jet.thrust_0 * random.uniform(0.9, 1.25);
  return jet;
}

Jet fin_at(const Craft& craft, const Vector3d& position, const Vector3d& axis, double area, Random& random) {
  Jet jet{.position = position, .axis = axis, .drive = Drive::kFin, .area = area};
  jet.aspect = random.uniform(1.8, 3.0);
  jet.slope = 2.0 * kPi * jet.aspect / (jet.aspect + 2.4);  // lifting line with a correction for short spans
  jet.stall = random.uniform(0.5, 0.62);
  jet.reference = std::round(10.0 * craft.pace[0]) / 10.0;
  jet.largest = 0.6 * jet.stall * 0.5 * craft.density * area * jet.slope * jet.reference * jet.reference;
  return jet;
}

void cut_strips(double side, double plan, double drag, Craft& craft) {
  const double length = craft.extent.x() / kStrips;
  for (int i = 0; i < kStrips; ++i) {
    const double x = -0.5 * craft.extent.x() + (i + 0.5) * length;
    craft.strips.push_back({x, length, side, plan});
  }
  craft.cross_drag = drag;
  const Vector6 pure = pure_cross_drag(craft);
  for (const int k : {1, 2, 4, 5}) craft.hull.quadratic[k] += pure[k];
}

/// A round hull: mass, moments, added mass, drag; and its lift, behind the middle (Hoerner 1965; Prestero 2001).
void load_round_hull(double diameter, double drag, Random& random, Craft& craft) {
  Hull& hull = craft.hull;
  const double length = craft.extent.x();
  hull.mass = craft.density * 0.25 * kPi * diameter * diameter * length * random.uniform(0.75, 0.88);
  const double about = hull.mass * length * length / 12.0 * random.uniform(0.7, 0.9);
  hull.inertia << hull.mass * diameter * diameter / 8.0 * random.uniform(0.9, 1.3), about, about;
  hull.added << 0.03 * hull.mass, 1.1 * hull.mass, 1.1 * hull.mass, 0.3 * hull.inertia[0], 1.2 * about, 1.2 * about;
  for (double& one : hull.added) one *= random.uniform(0.85, 1.15);
  hull.quadratic[0] = 0.5 * craft.density * 0.25 * kPi * diameter * diameter * drag * random.uniform(0.8, 1.3);
  hull.linear << 0.1 * hull.quadratic[0], 2.0, 2.0, 1.5 * hull.inertia[0], 0.15 * about, 0.15 * about;
  hull.quadratic[3] = 0.5 * hull.inertia[0];
  cut_strips(diameter, diameter, random.uniform(0.8, 1.1), craft);
  const double area = diameter * diameter, slope = 0.172 * length / diameter * random.uniform(0.85, 1.15);
  for (const bool upright : {true, false})
    craft.foils.push_back({{-0.24 * length, 0.0, 0.0}, upright, area, slope, 0.6, 0.9});
}

Craft torpedo(Random& random, Craft craft) {
  const double length = random.log_uniform(1.2, 2.2), diameter = length / random.uniform(6.5, 8.0);
  craft.extent << length, diameter, diameter;
  craft.pace << random.uniform(1.1, 1.7), 0.08, 0.1, 0.1, 0.12, 0.2;
  load_round_hull(diameter, 0.27, random, craft);
  Hull& hull = craft.hull;
  hull.net_weight = hull.mass * kGravity * random.uniform(-0.012, 0.002);
  hull.first_moment << 0.0, 0.0, hull.mass * kGravity * random.uniform(0.015, 0.03);
  Jet propeller = propeller_at({-0.5 * length, 0.0, 0.0}, 0.72 * diameter, random);
  propeller.torque = 0.15 * propeller.diameter;
  propeller.largest = thrust_for(craft, propeller, hull.quadratic[0], 1.35 * craft.pace[0]);
  craft.jets.push_back(propeller);
  const double area = 0.0075 * length * length * random.uniform(0.85, 1.2);
  for (const Vector3d& axis : {Vector3d(0.0, 1.0, 0.0), Vector3d(0.0, 0.0, 1.0)})
    craft.jets.push_back(fin_at(craft, {-0.47 * length, 0.0, 0.0}, axis, area, random));
  craft.actuated = craft.moves = {true, true, true, false, true, true};  // it hangs upright by its weight alone
  return craft;
}

/// A hull of `beam` and `draft`, one of `hulls`, at the surface.
void load_surface_hull(double beam, double draft, int hulls, double resistance, Random& random, Craft& craft) {
  Hull& hull = craft.hull;
  const double length = craft.extent.x(), n = hulls;
  hull.mass = craft.density * n * length * beam * draft * random.uniform(0.62, 0.78);
  const double radius = random.uniform(0.23, 0.28) * length;
  hull.inertia << hull.mass * 0.12 * std::pow(craft.extent.y(), 2), hull.mass * radius * radius,
      hull.mass * (radius * radius + (hulls > 1 ? 0.1 * std::pow(craft.extent.y(), 2) : 0.0));
  const double slice = 0.5 * craft.density * kPi * draft * draft * n;  // kg/m, half a lens
  hull.added << 0.06 * hull.mass, 0.85 * slice * length, hull.mass, 0.2 * hull.inertia[0], hull.inertia[1],
      0.65 * slice * std::pow(length, 3) / 12.0;
  for (double& one : hull.added) one *= random.uniform(0.85, 1.15);
  const double wet = n * length * (2.0 * draft + beam);
  hull.quadratic[0] = 0.5 * craft.density * wet * resistance * random.uniform(0.8, 1.3);
  hull.linear << 0.15 * hull.quadratic[0] * craft.pace[0], 0.05 * hull.mass, 1.0, 1.0, 1.0, 0.12 * hull.inertia[2];
  hull.quadratic.segment<3>(2).setOnes();
  cut_strips(draft * (1.0 + 0.5 * (n - 1.0)), 0.0, random.uniform(0.6, 1.0), craft);
  // The hull as a wing of low aspect, doubled by its image in the surface; the load sits aft (Inoue 1981).
  const double aspect = 2.0 * draft / length, slope = 0.5 * kPi * aspect * random.uniform(0.85, 1.15);
  const double area = n * length * draft;
  craft.foils.push_back({{-0.42 * length, 0.0, 0.0}, true, 0.75 * area, slope, 0.6, aspect});
  craft.foils.push_back({{0.06 * length, 0.0, 0.0}, true, 0.25 * area, slope, 0.6, aspect});
  craft.surfaced = true;
  craft.moves = {true, true, false, false, false, true};
}

Craft boat(Random& random, Craft craft) {
  const double length = random.log_uniform(1.1, 2.4), apart = length * random.uniform(0.4, 0.6);
  const double beam = 0.11 * length, draft = length * random.uniform(0.06, 0.09);
  craft.extent << length, apart + beam, 3.0 * draft;
  craft.pace << random.uniform(0.8, 1.4), 0.1, 0.05, 0.05, 0.05, 0.35;
  load_surface_hull(beam, draft, 2, 0.009, random, craft);
  const bool propellers = random.chance(0.5);
  for (const double side : {-1.0, 1.0}) {
    const Vector3d place(-0.42 * length, 0.5 * side * apart, 0.7 * draft);
    Jet jet{.position = place, .axis = Vector3d::UnitX()};
    const double half = 0.5 * craft.hull.quadratic[0];
    if (propellers) {
      if (side < 0.0) {
        jet = propeller_at(place, 0.9 * draft, random);
      } else {
        jet = craft.jets.front();
        jet.position = place;
      }
      jet.largest = thrust_for(craft, jet, half, 1.7 * craft.pace[0]);
    } else {
      jet.largest = 3.0 * half * craft.pace[0] * craft.pace[0];
    }
    craft.jets.push_back(jet);
  }
  if (random.chance(0.6)) craft.windage = length * random.uniform(0.12, 0.3);
  craft.actuated = {true, false, false, false, false, true};
  return craft;
}

Craft ship(Random& random, Craft craft) {
  const double length = random.log_uniform(1.3, 6.0), beam = length / random.uniform(4.5, 6.0);
  const double draft = beam / random.uniform(2.4, 3.0);
  craft.extent << length, beam, 2.0 * draft;
  craft.pace << std::sqrt(kGravity * length) * random.uniform(0.15, 0.24), 0.08, 0.05, 0.05, 0.05, 0.0;
  craft.pace[5] = 0.35 * craft.pace[0] / length;
  load_surface_hull(beam, draft, 1, 0.008, random, craft);
  Jet propeller = propeller_at({-0.47 * length, 0.0, 0.6 * draft}, 0.65 * draft, random);
  propeller.largest = thrust_for(craft, propeller, craft.hull.quadratic[0], 1.3 * craft.pace[0]);
  craft.jets.push_back(propeller);
  Jet rudder = fin_at(craft, {-0.5 * length, 0.0, 0.6 * draft}, Vector3d::UnitY(),
                      random.uniform(0.018, 0.028) * length * draft, random);
  rudder.behind = 0;
  rudder.diameter = propeller.diameter;
  rudder.share = std::round(random.uniform(40.0, 80.0)) / 100.0;
  craft.jets.push_back(rudder);
  craft.windage = length * beam * random.uniform(0.25, 0.6);
  craft.actuated = craft.moves;
  return craft;
}

Craft glider(Random& random, Craft craft) {
  const double length = random.uniform(1.4, 2.0), diameter = length / random.uniform(6.5, 8.0);
  craft.extent << length, diameter, diameter;
  craft.pace << random.uniform(0.3, 0.4), 0.02, 0.06, 0.02, 0.03, 0.02;
  load_round_hull(diameter, 0.2, random, craft);
  Hull& hull = craft.hull;
  hull.added[2] *= 1.3;  // wings across the flow
  hull.first_moment << 0.0, 0.0, hull.mass * kGravity * random.uniform(0.008, 0.013);
  const double span_area = 0.05 * length * length;
  craft.foils.push_back({{-0.06 * length, 0.0, 0.0}, false, span_area, 4.2, 0.3, 7.0});
  craft.foils.push_back({{-0.45 * length, 0.0, 0.0}, true, 0.015 * length * length, 3.0, 0.45, 2.0});
  Jet engine{
      .position = {random.uniform(0.3, 0.45) * length, 0.0, 0.0}, .axis = Vector3d::UnitZ(), .drive = Drive::kGained};
  engine.largest = hull.mass * kGravity * random.uniform(0.005, 0.008);
  Jet battery{.position = Vector3d::Zero(), .axis = Vector3d::UnitX(), .drive = Drive::kMoved};
  battery.moved_mass = std::round(0.18 * hull.mass);
  battery.largest = 0.5 * hull.first_moment[2];
  craft.jets = {engine, battery};
  craft.actuated = craft.moves = {true, false, true, false, true, false};
  return craft;
}

}  // namespace

Craft draw_other_craft(CraftClass craft_class, Random& random) {
  Craft craft;
  craft.craft_class = craft_class;
  craft.family = kClassNames[static_cast<std::size_t>(craft_class)];
  craft.density = random.chance(0.4) ? random.uniform(996.0, 1000.0) : random.uniform(1018.0, 1028.0);
  craft.nominal_voltage = std::round(random.uniform(13.0, 25.0));
  switch (craft_class) {
    case CraftClass::kTorpedo:
      return torpedo(random, craft);
    case CraftClass::kBoat:
      return boat(random, craft);
    case CraftClass::kShip:
      return ship(random, craft);
    default:
      return glider(random, craft);
  }
}

}  // namespace fathom::sealed
