#include "common/simulation/hidden.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <map>
#include <numbers>

#include "common/base/error.hpp"
#include "common/model/vehicle.hpp"
#include "common/simulation/random.hpp"

namespace fathom::simulation {
namespace {

constexpr double kOpenWater = 10.0;     // m around the start, where there are no walls
constexpr double kEdge = 0.15;          // m, how wide the edge of a layer is
constexpr double kBoundaryDrag = 0.5;   // m^2, or plain at the boundary itself
constexpr double kTiltShare = 0.3;      // of the righting moment that an unknown one may have
constexpr double kMassShare = 0.15;     // of the vehicle's mass that a payload may have
constexpr double kFlown = 200.0;        // s: a trial's limit may be far behind its end, and nothing would happen in it
constexpr double kTurnTakes = 30.0;     // s, of a stream
constexpr double kTypicalSpeed = 0.3;   // m/s, rad/s
constexpr double kTypicalThrust = 0.4;  // of the largest

using Given = std::map<std::string, std::string>;

Given parse(const std::string& text, std::string& name) {
  Given given;
  const auto equals = text.find('=');
  name = text.substr(0, equals);
  if (equals == std::string::npos) return given;
  std::size_t at = equals + 1;
  while (at < text.size()) {
    const std::size_t end = std::min(text.find(',', at), text.size());
    const std::string item = text.substr(at, end - at);
    const auto colon = item.find(':');
    if (colon == std::string::npos || colon == 0) {
      throw InputError("--hide " + text + ": '" + item + "' is not parameter:value");
    }
    given[item.substr(0, colon)] = item.substr(colon + 1);
    at = end + 1;
  }
  return given;
}

template <class Names>
std::string list(const Names& names) {
  std::string text;
  for (const auto& each : names) {
    if (!each.empty() && each != "-") text += (text.empty() ? "" : ", ") + std::string{each};
  }
  return text;
}

model::Scene scene_at(const Occasion& occasion, RandomStream& stream) {
  const model::Vehicle& vehicle = *occasion.vehicle;
  const model::Site& site = *occasion.site;
  model::Scene scene{.vehicle = &vehicle, .position = true, .attitude = true, .velocity = true, .rates = true};
  scene.voltage = occasion.voltage > 0.0;
  scene.mean_voltage = occasion.voltage;
  scene.voltage_range = 0.1 * occasion.voltage;
  scene.duration = scene.t_high = occasion.duration;
  const auto low = [](double wall, double start) { return std::isfinite(wall) ? wall : start - kOpenWater; };
  const auto high = [](double wall, double start) { return std::isfinite(wall) ? wall : start + kOpenWater; };
  scene.p_low = {low(site.south, occasion.start.x()), low(site.west, occasion.start.y()), site.surface};
  scene.p_high = {high(site.north, occasion.start.x()), high(site.east, occasion.start.y()), site.floor};
  scene.nu_rms.setConstant(kTypicalSpeed);
  const double thrust = kTypicalThrust * (vehicle.largest_thrust > 0.0 ? vehicle.largest_thrust : 20.0);
  scene.force_rms.setConstant(vehicle.allocation.cols(), thrust);
  scene.tau_rms = vehicle.allocation.cwiseAbs() * scene.force_rms;
  scene.tilt_rms = 0.05;
  const double bearing = stream.uniform(-std::numbers::pi, std::numbers::pi);
  const model::Tone tone{.omega = stream.uniform(0.6, 2.5),
                         .cosine = Eigen::Vector3d{std::cos(bearing), std::sin(bearing), 1.0},
                         .sine = Eigen::Vector3d{0.0, 0.0, 0.0}};
  scene.tones_horizontal = {tone};
  scene.tones_vertical = {tone};
  return scene;
}

// The wall that is nearest to the start, as bearing and distance along it from the site's origin.
void nearest_wall(const Occasion& occasion, double& bearing, double& distance) {
  const model::Site& site = *occasion.site;
  const std::array<std::array<double, 3>, 4> walls{
      {{0.0, site.north, site.north - occasion.start.x()},
       {0.5 * std::numbers::pi, site.east, site.east - occasion.start.y()},
       {std::numbers::pi, -site.south, occasion.start.x() - site.south},
       {-0.5 * std::numbers::pi, -site.west, occasion.start.y() - site.west}}};
  const auto nearest =
      std::min_element(walls.begin(), walls.end(), [](const auto& a, const auto& b) { return a[2] < b[2]; });
  bearing = (*nearest)[0];
  distance = std::isfinite((*nearest)[1]) ? (*nearest)[1] : kOpenWater;
}

double drawn(const model::ActiveEffect& active, const model::EffectParameter& parameter, const Occasion& occasion,
             const model::Scene& scene, RandomStream& stream) {
  const model::Site& site = *occasion.site;
  const model::Traits& traits = active.effect->traits();
  const std::string_view name = parameter.name;
  const Eigen::Vector3d anchor =
      site.tether_anchor ? *site.tether_anchor : Eigen::Vector3d{occasion.start + Eigen::Vector3d{-3.0, 0.0, -1.0}};
  double wall_bearing{}, wall_distance{};
  nearest_wall(occasion, wall_bearing, wall_distance);
  const double share = stream.uniform(0.5, 1.5), side = stream.uniform();  // always two draws: parameters stay apart
  if (name == "anchor_N") return anchor.x();
  if (name == "anchor_E") return anchor.y();
  if (name == "anchor_D") return anchor.z();
  if (name == "slack_length") return (0.6 + 0.2 * share) * (anchor - occasion.start).norm();
  if (name == "from") return 0.0;
  if (name == "until") return std::min(occasion.duration, kFlown);
  if (name == "onset") return (0.5 * share) * std::min(occasion.duration, kFlown);
  if (name == "bottom_depth" || name == "at_depth") return site.floor;
  // The edge of a layer lies between the start and the floor.
  if (name == "edge_depth")
    return occasion.start.z() + (std::isfinite(site.floor) ? 0.4 * share * (site.floor - occasion.start.z()) : share);
  if (name == "edge_width") return kEdge * share;
  if (name == "bearing") return traits.stage == model::Stage::kWater ? 2.0 * std::numbers::pi * side : wall_bearing;
  if (name == "distance" || name == "at_distance") return wall_distance;
  if (name == "frequency") return scene.tones_horizontal.front().omega;
  if (name == "duration") return kTurnTakes * share;
  // What a boundary adds is a share of the hull's own drag, and never takes drag away.
  if (name == "strength" && active.effect->multiplies_drag(active.variant)) return kBoundaryDrag * share;
  double size = share * parameter.sigma * active.effect->form(active.variant).traits().drawn;
  if (parameter.drawn_within == model::DrawnWithin::kRightingMoment)
    size = std::min(size, kTiltShare * share * occasion.righting);
  if (parameter.drawn_within == model::DrawnWithin::kVehicleMass && occasion.vehicle->mass > 0.0)
    size = std::min(size, kMassShare * share * occasion.vehicle->mass);
  if (parameter.low < 0.0 && side < 0.5 && !traits.takes_energy) size = -size;
  return std::clamp(size, parameter.low, parameter.high);
}

double number(const std::string& text, const std::string& word) {
  double value{};
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error != std::errc{} || end != word.data() + word.size() || !std::isfinite(value)) {
    throw InputError("--hide " + text + ": '" + word + "' is no number (SI, without unit)");
  }
  return value;
}

}  // namespace

model::ActiveEffect hidden_effect(const std::string& text, const Occasion& occasion, std::uint64_t seed) {
  std::string name;
  Given given = parse(text, name);
  const model::Effect* effect = model::find_effect(name);
  if (effect == nullptr) {
    std::vector<std::string_view> names;
    for (const model::Effect* each : model::all_effects()) names.push_back(each->name());
    throw InputError("--hide " + text + ": no effect '" + name + "'; there are " + list(names));
  }
  RandomStream stream{seed, "hide." + name};
  model::Scene scene = scene_at(occasion, stream);
  if (effect->measures()) scene.position = scene.attitude = false;  // else it would be left to kinematics to find
  const std::vector<std::string> variants = effect->variants(scene);
  std::vector<int> usable;
  for (std::size_t i = 0; i < variants.size(); ++i) {
    if (variants[i] != "-") usable.push_back(static_cast<int>(i));
  }
  if (usable.empty()) throw InputError("--hide " + text + ": cannot act on this vehicle at this site");
  model::ActiveEffect active{.effect = effect};
  active.variant = usable[static_cast<std::size_t>(stream.uniform() * static_cast<double>(usable.size()))];
  // A form without a name is the ordinary one: others are asked for.
  const auto ordinary = std::find(variants.begin(), variants.end(), "");
  if (ordinary != variants.end()) active.variant = static_cast<int>(ordinary - variants.begin());
  if (const auto wanted = given.find("variant"); wanted != given.end()) {
    const auto found = std::find(variants.begin(), variants.end(), wanted->second);
    if (found == variants.end() || wanted->second == "-") {
      throw InputError("--hide " + text + ": no variant '" + wanted->second + "'; there are " + list(variants));
    }
    active.variant = static_cast<int>(found - variants.begin());
    given.erase(wanted);
  }
  active.variant_name = variants[static_cast<std::size_t>(active.variant)];
  std::vector<std::string_view> names;
  for (const model::EffectParameter& parameter : effect->parameters()) {
    if (!effect->is_told(active.variant, active.theta.size())) {
      active.theta.push_back(0.0);
      continue;
    }
    names.push_back(parameter.name);
    double value = drawn(active, parameter, occasion, scene, stream);
    if (const auto stated = given.find(std::string{parameter.name}); stated != given.end()) {
      value = number(text, stated->second);
      if (value < parameter.low || value > parameter.high) {
        throw InputError("--hide " + text + ": " + stated->second + " is outside of what " +
                         std::string{parameter.name} + " can be");
      }
      given.erase(stated);
    }
    active.theta.push_back(value);
  }
  if (!given.empty()) {
    names.push_back("variant");
    throw InputError("--hide " + text + ": " + name + " has no '" + given.begin()->first + "'; it has " + list(names));
  }
  return active;
}

}  // namespace fathom::simulation
