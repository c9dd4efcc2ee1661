#include "common/model/manoeuvring/helm.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "common/base/error.hpp"
#include "common/model/derivative_motion.hpp"
#include "common/model/manoeuvring/standard_set.hpp"

namespace fathom::model {
namespace {

constexpr double kSideways = 0.7;  // of a unit axis: a rudder's force, not a plane's
constexpr double kMost = 1e9;      // N: no propeller gives as much
constexpr int kHalvings = 60;
constexpr double kStraight = 2.0;  // lengths ahead before it turns: the course is held
constexpr double kTurned = 40.0;   // lengths in all: two circles of a ship that turns hard and loses half of its speed

bool is_rudder(const Thruster& one) { return one.fin && std::abs(one.axis_B.y()) > kSideways; }

double cruise_of(const Vehicle& vehicle) {
  require_derivatives(vehicle);
  if (vehicle.hydrodynamics->cruise > 0.0) return vehicle.hydrodynamics->cruise;
  throw InputError(vehicle.name +
                   ": who steers by rudders is flown from a cruising speed: state 'cruise' in the section "
                   "hydrodynamics of the vehicle file");
}

}  // namespace

bool steered_by_rudder(const Vehicle& vehicle) { return std::ranges::any_of(vehicle.thrusters, is_rudder); }

Manoeuvre manoeuvre_for(const Vehicle& vehicle, const std::string& name) {
  if (!steered_by_rudder(vehicle)) return {.kind = manoeuvre_from(name)};
  const double length = vehicle.hydrodynamics ? vehicle.hydrodynamics->length : 0.0;
  const double passed = length / cruise_of(vehicle);  // s in which it goes its own length
  const Manoeuvre preset{.kind = manoeuvre_from(name)};
  return {.kind = preset.kind,
          .rest = 0.0,
          .straight = kStraight * passed,
          .duration = std::max(kTurned * passed, preset.duration)};
}

Helm::Helm(const Vehicle& vehicle, const Manoeuvre& manoeuvre)
    : vehicle_{vehicle},
      manoeuvre_{manoeuvre},
      steered_{steered_by_rudder(vehicle)},
      force_{ActuatorForces::Zero(vehicle.allocation.cols())} {
  const bool pair = vehicle.thrusters.size() == 2 &&
                    std::ranges::none_of(vehicle.thrusters, [](const Thruster& one) { return one.fin || one.weight; });
  if (!steered_ && !pair)
    throw InputError(vehicle.name + ": these manoeuvres are flown with two thrusters, or with a rudder");
  if (steered_) keep_cruise();
}

const ActuatorForces& Helm::forces(const ManoeuvrePilot::Demand& demand, double dt) {
  if (!steered_) {
    force_ << demand.ahead + demand.turn, demand.ahead - demand.turn;
    return force_;
  }
  // A positive angle pushes the stern to starboard: the craft turns to port.
  const double wanted = demand.turn == 0.0 ? 0.0 : std::copysign(manoeuvre_.rudder, -demand.turn);
  const double most = manoeuvre_.rudder_rate > 0.0 ? manoeuvre_.rudder_rate * dt : 2.0 * manoeuvre_.rudder;
  angle_ += std::clamp(wanted - angle_, -most, most);
  for (std::size_t i = 0; i < vehicle_.thrusters.size(); ++i) {
    const Thruster& one = vehicle_.thrusters[i];
    if (!is_rudder(one)) continue;
    const double angle = std::clamp(angle_, -one.fin->stall, one.fin->stall);
    force_[static_cast<Eigen::Index>(i)] = one.fin->slope * std::copysign(angle, angle * one.axis_B.y());
  }
  return force_;
}

/// u_dot [m/s^2] straight ahead at the cruising speed, each propeller with this force at rest [N].
double Helm::gain(double thrust) {
  for (std::size_t i = 0; i < vehicle_.thrusters.size(); ++i) {
    const Thruster& one = vehicle_.thrusters[i];
    if (!one.fin && !one.weight) force_[static_cast<Eigen::Index>(i)] = thrust;
  }
  Motion motion;
  motion.nu[0] = cruise_of(vehicle_);
  motion.force = force_;
  motion.vehicle = &vehicle_;
  const Vector6d force = vehicle_.hydrodynamics->set->pushed(vehicle_, motion) + hull_wrench(vehicle_, motion);
  return accelerated(vehicle_, total_inertia(vehicle_), force)[0];
}

/// Propellers all alike; none where the set's own terms hold the speed.
void Helm::keep_cruise() {
  if (gain(0.0) >= 0.0) return;
  double low = 0.0, high = 1.0;
  while (gain(high) < 0.0) {
    low = high;
    high *= 2.0;
    if (high > kMost) throw InputError(vehicle_.name + ": no thrust of its propellers keeps the cruising speed");
  }
  for (int i = 0; i < kHalvings; ++i) {
    const double middle = 0.5 * (low + high);
    (gain(middle) < 0.0 ? low : high) = middle;
  }
  static_cast<void>(gain(high));
}

TurnFigures turn_figures(const std::vector<FlightMoment>& flight, const Manoeuvre& manoeuvre) {
  TurnFigures figures;
  const double begin = manoeuvre.rest + manoeuvre.straight;
  const auto yaw = [](const FlightMoment& m) { return euler_from_rotation(m.q_WB.toRotationMatrix()).z(); };
  const auto first = std::ranges::find_if(flight, [&](const FlightMoment& m) { return m.t >= begin; });
  if (first == flight.end()) return figures;
  const Eigen::AngleAxisd course{manoeuvre.heading, Eigen::Vector3d::UnitZ()};
  double before = yaw(*first), turned = wrap_angle(before - manoeuvre.heading);
  for (auto m = first; m != flight.end(); ++m) {
    turned += wrap_angle(yaw(*m) - before);
    before = yaw(*m);
    const Eigen::Vector3d way = course.inverse() * (m->p_WB - first->p_WB);
    const double side = std::copysign(way.y(), way.y() * turned);
    if (!figures.advance && std::abs(turned) >= 0.5 * std::numbers::pi) {
      figures.advance = way.x();
      figures.transfer = side;
    }
    if (!figures.tactical_diameter && std::abs(turned) >= std::numbers::pi) figures.tactical_diameter = side;
  }
  const FlightMoment& last = flight.back();
  if (last.nu[5] != 0.0) figures.radius = last.nu.head<2>().norm() / std::abs(last.nu[5]);
  return figures;
}

}  // namespace fathom::model
