#include "common/simulation/truth.hpp"

#include <algorithm>

#include "common/base/config.hpp"
#include "common/base/error.hpp"
#include "common/model/vehicle.hpp"

namespace fathom::simulation {
namespace {

constexpr Utime kFinest = 100;  // us: what step and interval are multiples of

}  // namespace

Utime microseconds(const Config& config, const std::string& key) {
  const Utime value = utime_after(0, config.positive(key, "s"));
  if (value <= 0 || value % kFinest != 0) config.fail(key, "'" + key + "' must be a multiple of 0.1 ms");
  return value;
}

Utime interval_of(const Config& config) {
  const Utime step = microseconds(config, "step"), interval = microseconds(config, "interval");
  if (interval % step != 0) config.fail("interval", "'interval' must be a multiple of 'step'");
  return interval;
}

double limit_of(const Config& config, const model::Vehicle& vehicle) {
  if (config.has("largest_thrust")) return config.positive("largest_thrust", "N");
  if (vehicle.largest_thrust > 0.0) return vehicle.largest_thrust;
  if (!vehicle.curve.empty()) return model::Site::kNone;  // the curve's ends are the limits
  config.fail("largest_thrust", "state 'largest_thrust' here or in the vehicle file: it has no thrust curve either");
}

// Base parameters of the truth: those stated, else the vehicle file's means.
model::Model truth_of(const Config& config, const model::Vehicle& vehicle, const model::Vehicle& whole) {
  const Config stated = config.section("truth");
  model::Model truth = model::nominal_model(vehicle, false);
  truth.vehicle = &whole;
  for (const model::BaseParameter parameter : model::base_parameters()) {
    const std::string name{model::name(parameter)};
    if (stated.has(name)) {
      truth.theta[model::index(parameter)] = stated.quantity(name, std::string{model::unit(parameter)});
    }
  }
  for (const model::BaseParameter parameter : model::base_parameters()) {
    const std::string name{model::name(parameter)};
    const double value = truth.theta[model::index(parameter)];
    if (!stated.has(name) &&
        std::find(vehicle.parameters.begin(), vehicle.parameters.end(), name) == vehicle.parameters.end()) {
      stated.fail(name, "'" + name +
                            "' is missing: the vehicle file has no mean for it, and the truth moves in all six "
                            "degrees of freedom");
    }
    const int sign = model::sign_constraint(parameter);
    if (sign > 0 && value <= 0.0) stated.fail(name, "'" + name + "' must be positive");
    if (sign < 0 && value > 0.0) stated.fail(name, "'" + name + "' must not be positive: drag opposes motion");
  }
  return truth;
}

std::optional<DerivativeTruth> derivatives_of(const Config& config, const model::Vehicle& vehicle,
                                              const model::Site& site, std::uint64_t seed) {
  if (!config.has("derivatives")) return std::nullopt;
  if (config.has("truth")) config.fail("truth", "'truth' and 'derivatives' are two truths; state one");
  model::require_derivatives(vehicle);
  const Config stated = config.section("derivatives");
  if (vehicle.hydrodynamics->chain && vehicle.hydrodynamics->chain->seabed != site.floor) {
    stated.fail("umbilical_pull",
                "the chain of " + vehicle.name + " drags on another seabed than the floor of " + site.name);
  }
  return DerivativeTruth{
      .pull = stated.not_negative("umbilical_pull", "N"), .memory = stated.positive("pull_memory", "s"), .seed = seed};
}

model::Model derivative_model(const model::Vehicle& vehicle, const model::Vehicle& whole) {
  model::Model truth = model::nominal_model(vehicle, false);
  truth.vehicle = &whole;
  truth.theta = model::nearest_base(vehicle);
  return truth;
}

BatteryTruth battery_of(const Config& config) {
  if (!config.has("battery")) return {};
  const Config battery = config.section("battery");
  return {.full = battery.positive("full", "V"),
          .fall = battery.not_negative("fall", "V/s"),
          .sag = battery.not_negative("sag", "V"),
          .lowest = battery.positive("lowest", "V")};
}

StartPose start_of(const Config& config, const model::Site& site, const Eigen::Vector3d& hull) {
  const Config starts = config.section("start");
  if (!starts.has(site.name)) {
    starts.fail(site.name, "no start is stated for the site '" + site.name + "': add '" + site.name +
                               ": {position: ..., heading: ...}'");
  }
  for (const std::string& other : starts.keys()) {  // read all, so that a start for another site is no unknown key
    const Config start = starts.section(other);
    static_cast<void>(start.vector3("position", "m"));
    static_cast<void>(start.quantity("heading", "rad"));
  }
  const Config start = starts.section(site.name);
  StartPose pose{.p_WB = start.vector3("position", "m"), .heading = start.quantity("heading", "rad")};
  const double reach = 0.5 * hull.norm();
  for (const Plane& plane : solid_planes(site)) {
    if (plane.n.dot(pose.p_WB) - plane.offset < reach) {
      start.fail("position", "'position' leaves no room between the hull and the boundaries of " + site.name);
    }
  }
  return pose;
}

bool carried_at(const Config& sensor, const model::Site& site) {
  if (!sensor.has("sites")) return true;
  const std::vector<std::string> sites = sensor.texts("sites");
  return std::find(sites.begin(), sites.end(), site.name) != sites.end();
}

}  // namespace fathom::simulation
