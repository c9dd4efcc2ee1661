#include "common/model/vehicle.hpp"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "common/base/config.hpp"
#include "common/base/error.hpp"
#include "common/base/motions.hpp"
#include "common/model/actuators.hpp"
#include "common/model/after_abort.hpp"
#include "common/model/candidates/candidate.hpp"
#include "common/model/hull_in_flow.hpp"
#include "common/model/priors/bounded.hpp"
#include "common/model/priors/proportions.hpp"
#include "common/model/priors/wide_prior.hpp"
#include "common/model/vehicle_file.hpp"

namespace fathom::model {
namespace {

constexpr double kUnitTolerance = 0.01;      // an axis typed with three digits is still a unit vector
constexpr double kTriangleTolerance = 1e-9;  // a flat plate meets the triangle inequality exactly
constexpr double kControlTolerance = 1e-6;   // of a unit wrench, in the units of the allocation
constexpr double kAgreementTolerance =
    0.02;  // allocation typed with two digits against the one computed from positions

std::string number(double value) {
  std::string text = std::to_string(value);
  text.erase(text.find_last_not_of('0') + 1);
  if (text.back() == '.') text.pop_back();
  return text;
}

double positive(const Config& config, const std::string& key, const std::string& unit) {
  const double value = bounded::quantity(config, key, unit);
  if (value <= 0.0) config.fail(key, "'" + key + "' must be positive, not " + number(value) + " " + unit);
  return value;
}

void read_dof(const Config& config, Vehicle& vehicle) {
  for (const std::string& word : config.texts("dof")) {
    const auto found = std::find(kMotionNames.begin(), kMotionNames.end(), word);
    if (found == kMotionNames.end()) {
      config.fail("dof", "'" + word + "' is no degree of freedom: surge, sway, heave, roll, pitch, yaw");
    }
    bool& enabled = vehicle.dof[static_cast<std::size_t>(found - kMotionNames.begin())];
    if (enabled) config.fail("dof", "'" + word + "' stands here twice");
    enabled = true;
  }
  if (std::find(vehicle.dof.begin(), vehicle.dof.end(), true) == vehicle.dof.end()) {
    config.fail("dof", "at least one degree of freedom must be free");
  }
}

void read_body(const Config& config, Vehicle& vehicle) {
  vehicle.water_density = positive(config, "water_density", "kg/m^3");
  if (config.has("mass")) vehicle.mass = positive(config, "mass", "kg");
  if (config.has("buoyancy")) vehicle.buoyancy = positive(config, "buoyancy", "N");
  if (config.has("nominal_voltage")) vehicle.nominal_voltage = positive(config, "nominal_voltage", "V");
  if (config.has("largest_thrust")) vehicle.largest_thrust = positive(config, "largest_thrust", "N");
  if (config.has("hull")) {
    vehicle.hull = bounded::vector3(config, "hull", "m");
    if (vehicle.hull.minCoeff() <= 0.0) config.fail("hull", "'hull' must be positive along every axis");
  }
  if (!config.has("inertia")) return;
  vehicle.inertia = bounded::vector3(config, "inertia", "kg m^2");
  const Eigen::Vector3d& inertia = vehicle.inertia;
  if (inertia.minCoeff() <= 0.0) config.fail("inertia", "'inertia' must be positive about every axis");
  if (2.0 * inertia.maxCoeff() > inertia.sum() * (1.0 + kTriangleTolerance)) {
    config.fail("inertia", "no rigid body has this inertia: the largest moment exceeds the sum of the other two");
  }
}

void read_windage(const Config& config, Vehicle& vehicle) {
  if (!config.has("windage")) {
    vehicle.windage = assumed_windage(vehicle);
    return;
  }
  vehicle.windage = bounded::quantity(config, "windage", "m^2");
  if (vehicle.windage < 0.0) config.fail("windage", "'windage' must not be negative; 0 m^2: nothing stands out");
}

ThrustCurve read_curve(const Config& config) {
  ThrustCurve curve;
  curve.neutral_us = positive(config, "neutral", "us");
  curve.pwm_us = bounded::quantities(config, "pwm", "us");
  curve.force = bounded::quantities(config, "force", "N");
  if (curve.pwm_us.size() != curve.force.size()) {
    config.fail("force", "'pwm' has " + std::to_string(curve.pwm_us.size()) + " numbers and 'force' has " +
                             std::to_string(curve.force.size()));
  }
  if (curve.pwm_us.size() < 2) config.fail("pwm", "a thrust curve needs two points at least");
  for (std::size_t i = 1; i < curve.pwm_us.size(); ++i) {
    if (curve.pwm_us[i] <= curve.pwm_us[i - 1]) {
      config.fail("pwm", "'pwm' must rise: " + number(curve.pwm_us[i]) + " follows " + number(curve.pwm_us[i - 1]));
    }
    if (curve.force[i] < curve.force[i - 1]) {
      config.fail("force", "'force' must never fall: " + number(curve.force[i]) + " follows " +
                               number(curve.force[i - 1]) + " (use pwm_sign -1 for a thruster mounted in reverse)");
    }
  }
  if (curve.neutral_us < curve.pwm_us.front() || curve.neutral_us > curve.pwm_us.back()) {
    config.fail("neutral", "'neutral' lies outside of the curve");
  }
  if (config.has("voltage")) curve.voltage = positive(config, "voltage", "V");
  if (config.has("voltage_exponent")) {
    curve.voltage_exponent = bounded::quantity(config, "voltage_exponent", "");
    if (curve.voltage <= 0.0) config.fail("voltage_exponent", "'voltage_exponent' needs the 'voltage' of the curve");
  }
  return curve;
}

// Columns from positions and axes: [axis; p x axis]. Returns false when a thruster states neither.
bool read_thrusters(const Config& config, Vehicle& vehicle) {
  bool geometry = true;
  for (const Config& one : config.list("thrusters")) {
    Thruster thruster;
    thruster.name = one.text("name");
    for (const Thruster& other : vehicle.thrusters) {
      if (other.name == thruster.name) one.fail("name", "two thrusters are called '" + thruster.name + "'");
    }
    if (one.has("pwm_sign")) {
      thruster.pwm_sign = bounded::quantity(one, "pwm_sign", "");
      if (std::abs(thruster.pwm_sign) != 1.0) one.fail("pwm_sign", "'pwm_sign' must be 1 or -1");
    }
    if (one.has("position") || one.has("axis")) {
      thruster.p_BJ = bounded::vector3(one, "position", "m");
      thruster.axis_B = bounded::vector3(one, "axis", "");
      const double length = thruster.axis_B.norm();
      if (std::abs(length - 1.0) > kUnitTolerance) {
        one.fail("axis", "'axis' must be a unit vector; its length is " + number(length));
      }
      thruster.axis_B /= length;
    } else {
      geometry = false;
    }
    vehicle.thrusters.push_back(std::move(thruster));
  }
  if (vehicle.thrusters.empty())
    config.fail("thrusters", "the list is empty; leave 'thrusters' out for a wrench input");
  return geometry;
}

void read_allocation(const Config& config, bool geometry, Vehicle& vehicle) {
  const auto count = static_cast<Eigen::Index>(vehicle.thrusters.size());
  vehicle.allocation.setZero(6, count);
  if (geometry) {
    for (Eigen::Index j = 0; j < count; ++j) {
      const Thruster& thruster = vehicle.thrusters[static_cast<std::size_t>(j)];
      vehicle.allocation.col(j) << thruster.axis_B, thruster.p_BJ.cross(thruster.axis_B);
    }
  }
  if (!config.has("allocation")) {
    if (!geometry) config.fail("thrusters", "every thruster needs position and axis, unless 'allocation' is given");
    return;
  }
  const Config rows = config.section("allocation");
  for (int i = 0; i < 6; ++i) {
    const char* axis = kAxisNames[static_cast<std::size_t>(i)];
    const std::vector<double> row = bounded::quantities(rows, axis, i < 3 ? "" : "m");
    if (static_cast<Eigen::Index>(row.size()) != count) {
      rows.fail(axis, "row " + std::string(axis) + " has " + std::to_string(row.size()) + " numbers for " +
                          std::to_string(count) + " thrusters");
    }
    const Eigen::RowVectorXd given = Eigen::Map<const Eigen::RowVectorXd>(row.data(), count);
    if (geometry && (given - vehicle.allocation.row(i)).cwiseAbs().maxCoeff() > kAgreementTolerance) {
      rows.fail(axis, "row " + std::string(axis) + " contradicts the positions and axes of the thrusters");
    }
    vehicle.allocation.row(i) = given;
  }
}

// Free motions that the thrusters do not drive are normal (driven_axes.hpp); thrusters that push along none are not.
void check_authority(const Config& config, const std::string& key, const Vehicle& vehicle) {
  for (std::size_t i = 0; i < 6; ++i) {
    if (vehicle.dof[i] &&
        vehicle.allocation.row(static_cast<Eigen::Index>(i)).cwiseAbs().maxCoeff() > kControlTolerance)
      return;
  }
  config.fail(key, "the " + key + " push along none of the axes in 'dof'; correct their geometry");
}

Prior read_prior(const Config& config, const std::string& key, BaseParameter parameter, const Vehicle& vehicle) {
  const std::string wanted{unit(parameter)};
  const Config section = config.section(key);
  const Prior prior{bounded::quantity(section, "mean", wanted), bounded::quantity(section, "sigma", wanted)};
  if (prior.sigma <= 0.0) section.fail("sigma", "'sigma' must be positive");
  if (sign_constraint(parameter) > 0 && prior.mean <= 0.0) {
    section.fail("mean", "'" + key + "' must be positive");
  }
  const int turn = index(parameter) - index(BaseParameter::I_X);
  if (turn >= 0 && turn <= 2) check_moment(section, "mean", key, turn, prior.mean, vehicle);
  if (sign_constraint(parameter) < 0 && prior.mean > 0.0) {
    section.fail("mean", "'" + key + "' must not be positive: drag opposes motion (Fossen's sign)");
  }
  return prior;
}

void read_parameters(const Config& config, Vehicle& vehicle) {
  if (config.has("parameters")) {
    vehicle.parameters = config.texts("parameters");
  } else {
    vehicle.parameters = default_parameters(vehicle.dof);
  }
  std::vector<std::pair<std::string, Prior>> stated;
  if (config.has("priors")) {
    const Config priors = config.section("priors");
    for (const std::string& name : priors.keys()) {
      const std::optional<BaseParameter> parameter = parameter_from_name(name);
      if (!parameter) priors.fail(name, "'" + name + "' is no base parameter (docs/configuration.md lists them)");
      if (std::find(vehicle.parameters.begin(), vehicle.parameters.end(), name) == vehicle.parameters.end()) {
        priors.fail(name, "'" + name + "' has a prior but is not enabled; add it to 'parameters' or free its motion");
      }
      stated.emplace_back(name, read_prior(priors, name, *parameter, vehicle));
    }
  }
  for (const std::string& name : vehicle.parameters) {
    const std::optional<BaseParameter> parameter = parameter_from_name(name);
    if (!parameter) {
      config.fail("parameters", "'" + name + "' is no base parameter (docs/configuration.md lists them)");
    }
    if (std::count(vehicle.parameters.begin(), vehicle.parameters.end(), name) > 1) {
      config.fail("parameters", "'" + name + "' stands here twice");
    }
    const auto prior = std::find_if(stated.begin(), stated.end(), [&](const auto& one) { return one.first == name; });
    if (prior == stated.end() && vehicle.mass <= 0.0) {
      config.fail("mass", "state the 'mass', or a prior for every parameter ('" + name + "' has none)");
    }
    vehicle.priors.push_back(prior != stated.end() ? prior->second : wide_prior(*parameter, vehicle));
  }
}

void read_candidates(const Config& config, Vehicle& vehicle) {
  for (const std::string& text : config.texts("candidates")) {
    try {
      add_candidate(text, vehicle.candidates);
    } catch (const InputError& error) {
      config.fail("candidates", error.what());
    }
  }
}

}  // namespace

double ThrustCurve::force_at(double pwm) const {
  if (pwm_us.empty()) return 0.0;
  const auto above = std::upper_bound(pwm_us.begin(), pwm_us.end(), pwm);
  if (above == pwm_us.begin()) return force.front();
  if (above == pwm_us.end()) return force.back();
  const auto i = static_cast<std::size_t>(above - pwm_us.begin());
  const double share = (pwm - pwm_us[i - 1]) / (pwm_us[i] - pwm_us[i - 1]);
  return force[i - 1] + share * (force[i] - force[i - 1]);
}

double ThrustCurve::force_at(double pwm, double pwm_sign, double battery) const {
  const double at_reference = force_at(neutral_us + pwm_sign * (pwm - neutral_us));
  if (voltage_exponent == 0.0 || voltage <= 0.0) return at_reference;
  return at_reference * std::pow(battery / voltage, voltage_exponent);
}

Vehicle Vehicle::load(const std::string& path) { return vehicle_from(Config::load(path)); }

Vehicle vehicle_from(const Config& config) {
  Vehicle vehicle;
  vehicle.name = config.text("name");
  read_dof(config, vehicle);
  read_body(config, vehicle);
  vehicle.allocation.setZero(6, 0);
  if (config.has("thrusters")) {
    const bool geometry = read_thrusters(config, vehicle);
    read_allocation(config, geometry, vehicle);
    check_authority(config, "thrusters", vehicle);
  }
  if (config.has("actuators")) {
    read_actuators(config, vehicle);
    check_authority(config, "actuators", vehicle);
  }
  if (vehicle.has_thrusters() && config.has("thrust_curve")) vehicle.curve = read_curve(config.section("thrust_curve"));
  read_windage(config, vehicle);
  check_proportions(config, vehicle);
  read_parameters(config, vehicle);
  if (config.has("sensors")) {
    const Config sensors = config.section("sensors");
    vehicle.mounts = Mounts::from(sensors);
    for (const LoadCellMount& cell : vehicle.mounts.loads) {
      const bool known = std::any_of(vehicle.thrusters.begin(), vehicle.thrusters.end(),
                                     [&](const Thruster& thruster) { return thruster.name == cell.of; });
      if (cell.of != "tether" && !known) {
        sensors.fail("loads", "load cell '" + cell.name + "': 'of' must be tether or the name of a thruster, not '" +
                                  cell.of + "'");
      }
    }
  }
  if (config.has("candidates")) read_candidates(config, vehicle);
  if (config.has("hydrodynamics"))
    vehicle.hydrodynamics = Hydrodynamics::from(config.section("hydrodynamics"), vehicle.inertia);
  if (config.has("after_abort")) {
    const AfterAbort after = AfterAbort::from(config.section("after_abort"));
    if (after.action != AfterAbort::Action::kZero && !vehicle.dof[2])
      config.fail("after_abort", "this vehicle has no 'heave' in its 'dof': it can only have zero thrust");
  }
  config.finish();
  return vehicle;
}

}  // namespace fathom::model
