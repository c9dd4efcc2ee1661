#include "common/model/actuators.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "common/model/priors/bounded.hpp"
#include "common/model/sensors/kinematic_point.hpp"

namespace fathom::model {
namespace {

constexpr double kUnitLength = 0.01;  // an axis typed with three digits is still a unit vector
constexpr double kTurn = 2.0 * std::numbers::pi;
constexpr double kSteepest = 7.0;            // 1/rad: a wing of infinite span in potential flow has 2 pi
constexpr double kLeastLevel = 0.1;          // of a unit axis
constexpr double kLargestCoefficient = 2.0;  // of thrust: open propellers stay below 1, those in nozzles below 1.5

Thruster named(const Config& one, const Vehicle& vehicle) {
  Thruster thruster{.name = one.text("name")};
  const bool taken = std::ranges::any_of(vehicle.thrusters, [&](const Thruster& other) {
    return other.name == thruster.name || other.name == thruster.name + " x";
  });
  if (taken) one.fail("name", "two actuators are called '" + thruster.name + "'");
  return thruster;
}

Eigen::Vector3d axis_of(const Config& one) {
  const Eigen::Vector3d axis = bounded::vector3(one, "axis", "");
  if (std::abs(axis.norm() - 1.0) > kUnitLength) one.fail("axis", "'axis' must be a unit vector");
  return axis.normalized();
}

// T = rho D^4 (K_T0 n |n|) + rho D^3 K_TJ |n| u_a, n in revolutions per second (Fossen 2011, sec. 9.1 and eq. 12.236).
void read_propeller(const Config& one, const Vehicle& vehicle, Thruster& thruster) {
  const double diameter = bounded::positive(one, "diameter", "m");
  const double coefficient = bounded::positive(one, "K_T0", "");
  if (coefficient > kLargestCoefficient) one.fail("K_T0", "no propeller has a thrust coefficient above 2");
  const double density = vehicle.water_density;
  thruster.command = CommandKind::kShaftSpeed;
  thruster.diameter = diameter;
  thruster.per_square = density * std::pow(diameter, 4) * coefficient / (kTurn * kTurn);
  if (one.has("astern")) thruster.astern = bounded::positive(one, "astern", "");
  if (!one.has("K_TJ")) return;
  const double falls = bounded::quantity(one, "K_TJ", "");
  if (falls > 0.0) one.fail("K_TJ", "'K_TJ' must not be positive: thrust falls with the advance ratio J = u_a / (n D)");
  // |n| = sqrt(f_0 / (rho D^4 K_T0)).
  thruster.inflow = -falls * diameter * std::sqrt(density / coefficient);
}

// L = 1/2 rho A C_L V^2, C_L = slope times the deflection as far as the stall (Fossen 2011, sec. 9.7).
void read_fin(const Config& one, const Vehicle& vehicle, Thruster& thruster) {
  Fin fin;
  const double area = bounded::positive(one, "area", "m^2"), slope = bounded::positive(one, "lift_slope", "1/rad");
  if (slope > kSteepest) one.fail("lift_slope", "no fin lifts more than 2 pi per radian");
  fin.reference_speed = bounded::positive(one, "reference_speed", "m/s");
  fin.stall = bounded::positive(one, "stall", "rad");
  if (fin.stall > 0.5 * std::numbers::pi) one.fail("stall", "a fin stalls before 90 deg");
  fin.slope = 0.5 * vehicle.water_density * area * slope * fin.reference_speed * fin.reference_speed;
  thruster.command = CommandKind::kFinAngle;
  if (one.has("behind")) {
    const std::string name = one.text("behind");
    const auto found = std::ranges::find(vehicle.thrusters, name, &Thruster::name);
    if (found == vehicle.thrusters.end())
      one.fail("behind", "no actuator above is called '" + name + "': list a propeller before the rudder behind it");
    fin.behind = static_cast<int>(found - vehicle.thrusters.begin());
    // Momentum theory: a propeller of thrust f at rest makes a jet of V^2 = 2 f / (rho A_p); `share` of the square
    // reaches the fin.
    const double diameter = bounded::positive(one, "slipstream_diameter", "m");
    const double share = bounded::positive(one, "slipstream_share", "");
    if (share > 1.0) one.fail("slipstream_share", "no more than all of the slipstream reaches a fin");
    fin.slipstream = share * 2.0 / (vehicle.water_density * 0.25 * std::numbers::pi * diameter * diameter);
  }
  thruster.fin = fin;
}

// F = weight gained, down, at its place (Graver 2005, sec. 3.2: ballast as a point mass in the hull). Its inertia, some
// per mille of the vehicle's, is not modelled.
void read_gained(const Config& one, bool by_volume, const Vehicle& vehicle, Thruster& engine) {
  engine.p_BJ = bounded::vector3(one, "position", "m");
  engine.axis_B = Eigen::Vector3d::UnitZ();
  engine.command = CommandKind::kWeight;
  engine.weight =
      Weight{.kind = Weight::Kind::kGained, .per_command = by_volume ? -vehicle.water_density * kGravity : kGravity};
}

// A mass m that is moved by d from where it stands at command zero: M = d x m g, g along the world's down. What it does
// there belongs to the centre of mass (G_x, G_y, G_z).
void read_slid(const Config& one, Thruster& mass) {
  mass.axis_B = axis_of(one);
  if (mass.axis_B.head<2>().norm() < kLeastLevel)
    one.fail("axis", "a mass that moves straight up and down gives no moment when level: state the part that does");
  mass.command = CommandKind::kWeight;
  mass.weight = Weight{.kind = Weight::Kind::kSlid,
                       .per_command = bounded::positive(one, "mass", "kg") * kGravity,
                       .way_B = mass.axis_B};
}

// The same, hanging down at command zero and turned about an axis along the hull: d = r (sin(angle) way + (cos(angle) -
// 1) z).
void read_turned(const Config& one, Thruster& mass) {
  const Eigen::Vector3d axis_B = axis_of(one);
  if (std::abs(axis_B.z()) > kUnitLength) one.fail("axis", "'axis' of a turning mass must be level, '1 0 0' to roll");
  mass.axis_B = axis_B;
  mass.command = CommandKind::kWeight;
  mass.weight =
      Weight{.kind = Weight::Kind::kTurned,
             .per_command = bounded::positive(one, "mass", "kg") * kGravity * bounded::positive(one, "radius", "m"),
             .way_B = axis_B.cross(Eigen::Vector3d::UnitZ())};
}

/// Of a unit of force; of weights when level.
Vector6d column_of(const Thruster& thruster) {
  Vector6d column;
  column << thruster.axis_B, thruster.p_BJ.cross(thruster.axis_B);
  if (thruster.weight && thruster.weight->kind != Weight::Kind::kGained)
    column << Eigen::Vector3d::Zero(), thruster.weight->way_B.cross(Eigen::Vector3d::UnitZ());
  return column;
}

void add(Vehicle& vehicle, Thruster thruster) {
  const auto column = vehicle.allocation.cols();
  vehicle.allocation.conservativeResize(6, column + 1);
  vehicle.allocation.col(column) = column_of(thruster);
  vehicle.weight_moves = vehicle.weight_moves || thruster.weight.has_value();
  vehicle.flow_matters = vehicle.flow_matters || thruster.inflow > 0.0 || thruster.fin.has_value();
  vehicle.thrusters.push_back(std::move(thruster));
}

void read_one(const Config& one, Vehicle& vehicle) {
  Thruster actuator = named(one, vehicle);
  const std::string kind = one.text("kind");
  if (kind == "buoyancy_engine" || kind == "ballast_tank") {
    read_gained(one, kind == "buoyancy_engine", vehicle, actuator);
    return add(vehicle, std::move(actuator));
  }
  if (kind == "moving_mass" || kind == "turning_mass") {
    kind == "moving_mass" ? read_slid(one, actuator) : read_turned(one, actuator);
    return add(vehicle, std::move(actuator));
  }
  actuator.p_BJ = bounded::vector3(one, "position", "m");
  if (kind == "azimuth") {  // its angle counts from x to y of the body
    Thruster across = actuator;
    actuator.name += " x";
    actuator.axis_B = Eigen::Vector3d::UnitX();
    actuator.command = CommandKind::kAzimuthForce;
    across.name += " y";
    across.axis_B = Eigen::Vector3d::UnitY();
    across.command = CommandKind::kAzimuthAngle;
    add(vehicle, std::move(actuator));
    add(vehicle, std::move(across));
    return;
  }
  actuator.axis_B = axis_of(one);
  if (kind == "propeller") {
    read_propeller(one, vehicle, actuator);
  } else if (kind == "rudder" || kind == "fin") {
    read_fin(one, vehicle, actuator);
  } else if (kind == "thruster") {
    if (one.has("pwm_sign")) {
      actuator.pwm_sign = bounded::quantity(one, "pwm_sign", "");
      if (std::abs(actuator.pwm_sign) != 1.0) one.fail("pwm_sign", "'pwm_sign' must be 1 or -1");
    }
  } else {
    one.fail("kind", "'" + kind +
                         "' is no actuator: thruster, propeller, rudder, fin, azimuth, buoyancy_engine, ballast_tank, "
                         "moving_mass or turning_mass");
  }
  add(vehicle, std::move(actuator));
}

}  // namespace

void read_actuators(const Config& config, Vehicle& vehicle) {
  if (config.has("thrusters")) config.fail("actuators", "state 'thrusters' or 'actuators', not both");
  vehicle.allocation.setZero(6, 0);
  for (const Config& one : config.list("actuators")) read_one(one, vehicle);
  if (vehicle.thrusters.empty())
    config.fail("actuators", "the list is empty; leave 'actuators' out for a wrench input");
  if (vehicle.thrusters.size() > static_cast<std::size_t>(kMaxActuators))
    config.fail("actuators", "no more than " + std::to_string(kMaxActuators) + " actuators (an azimuth counts as two)");
}

bool takes_commands(const Vehicle& vehicle) {
  return !vehicle.curve.empty() || std::ranges::any_of(vehicle.thrusters, [](const Thruster& actuator) {
    return actuator.command != CommandKind::kForce;
  });
}

std::vector<double> forces_of_commands(const Vehicle& vehicle, std::span<const double> commands, double battery) {
  std::vector<double> force;
  force.reserve(commands.size());
  for (std::size_t i = 0; i < commands.size(); ++i) {
    const Thruster& actuator = vehicle.thrusters[i];
    const double command = commands[i];
    switch (actuator.command) {
      case CommandKind::kForce:
        force.push_back(vehicle.curve.empty() ? command : vehicle.curve.force_at(command, actuator.pwm_sign, battery));
        break;
      case CommandKind::kShaftSpeed:
        force.push_back(actuator.per_square * (command < 0.0 ? actuator.astern : 1.0) * command * std::abs(command));
        break;
      case CommandKind::kFinAngle:
        force.push_back(actuator.fin->slope * std::clamp(command, -actuator.fin->stall, actuator.fin->stall));
        break;
      case CommandKind::kAzimuthForce:
        force.push_back(command * std::cos(commands[i + 1]));
        break;
      case CommandKind::kAzimuthAngle:
        force.push_back(commands[i - 1] * std::sin(command));
        break;
      case CommandKind::kWeight:
        force.push_back(actuator.weight->per_command * (actuator.weight->kind == Weight::Kind::kTurned
                                                            ? std::sin(std::clamp(command, -0.25 * kTurn, 0.25 * kTurn))
                                                            : command));
        break;
    }
  }
  return force;
}

double acting_force(const Vehicle& vehicle, const Motion& motion, Eigen::Index i) {
  const Thruster& actuator = vehicle.thrusters[static_cast<std::size_t>(i)];
  const double told = motion.force[i];
  if (actuator.inflow > 0.0) {
    const double advance = vehicle.allocation.col(i).dot(motion.nu_r());  // axis . (v_r + w x p)
    const double size = std::sqrt(std::abs(told) / (told < 0.0 ? actuator.astern : 1.0));
    return told - actuator.inflow * size * advance;
  }
  if (!actuator.fin) return told;
  const Fin& fin = *actuator.fin;
  const Eigen::Vector3d v_r = motion.nu_r().head<3>() + motion.nu.tail<3>().cross(actuator.p_BJ);
  double square = v_r.x() * std::abs(v_r.x());  // (m/s)^2; going astern the fin pushes the other way
  // The jet's speed follows the thrust as it acts: of a propeller that advances less than at rest.
  if (fin.behind >= 0) square += fin.slipstream * std::max(acting_force(vehicle, motion, fin.behind), 0.0);
  return told * square / (fin.reference_speed * fin.reference_speed);
}

Vector6d acting_wrench(const Vehicle& vehicle, const Motion& motion, Eigen::Index i) {
  const Thruster& actuator = vehicle.thrusters[static_cast<std::size_t>(i)];
  if (!actuator.weight) return vehicle.allocation.col(i) * acting_force(vehicle, motion, i);
  const Weight& weight = *actuator.weight;
  const Eigen::Vector3d down_B = motion.R_WB.row(2).transpose();
  const double told = motion.force[i];
  Vector6d wrench;
  if (weight.kind == Weight::Kind::kGained) {
    wrench << told * down_B, actuator.p_BJ.cross(told * down_B);
    return wrench;
  }
  Eigen::Vector3d moved = told * weight.way_B;  // N m: weight times way
  if (weight.kind == Weight::Kind::kTurned) {
    const double sine = std::clamp(told / weight.per_command, -1.0, 1.0);
    moved.z() -= weight.per_command * (1.0 - std::sqrt(1.0 - sine * sine));
  }
  wrench << Eigen::Vector3d::Zero(), moved.cross(down_B);
  return wrench;
}

Vector6d acting_wrench(const Vehicle& vehicle, const Motion& motion) {
  if (!vehicle.flow_matters && !vehicle.weight_moves) return vehicle.allocation * motion.force;
  Vector6d sum = Vector6d::Zero();
  for (Eigen::Index i = 0; i < motion.force.size(); ++i) sum += acting_wrench(vehicle, motion, i);
  return sum;
}

}  // namespace fathom::model
