#include "common/preflight/applicability.hpp"

#include <algorithm>
#include <array>

#include "common/model/hull_in_flow.hpp"
#include "common/model/vehicle.hpp"

namespace fathom::preflight {
namespace {

using model::Effect;
using model::Scene;

/// One group of signals: where a scene says that it is there, and what is unknown without it.
struct Group {
  const char* name;
  bool Scene::*measured;
  const char* unknown;
};

constexpr std::array kGroups{Group{"position", &Scene::position, "what depends on the place is not known"},
                             Group{"attitude", &Scene::attitude, "what tilts the vehicle is not known"},
                             Group{"velocity", &Scene::velocity, "only what turns the vehicle was explained"},
                             Group{"rates", &Scene::rates, "only what moves the vehicle along was explained"}};

std::string joined(const std::vector<std::string>& words) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : ", ") + word;
  return text;
}

bool has_form(const Effect& effect, const Scene& scene) {
  return std::ranges::any_of(effect.variants(scene), [](const std::string& form) { return form != "-"; });
}

/// The vehicle in runs that leave nothing to wish for: everything measured, every axis moved, long and far. Forces are
/// asked about a sensor only where no pose checks it, so for those effects the pose stays as it is.
Scene everything(const Effect& effect, const Scene& scene) {
  Scene full = scene;
  for (const Group& group : kGroups) full.*group.measured = true;
  if (effect.measures()) {
    full.position = scene.position;
    full.attitude = scene.attitude;
  }
  full.voltage = true;
  full.mean_voltage = 15.0;  // V
  full.voltage_range = 5.0;
  full.t_low = 0.0;
  full.t_high = full.duration = 3600.0;  // s
  full.p_low.setConstant(-10.0);         // m
  full.p_high.setConstant(10.0);
  full.nu_rms.setOnes();
  full.tau_rms.setOnes();
  full.force_rms.setOnes(full.force_rms.size());
  full.tilt_rms = 0.3;  // rad
  full.tones_horizontal = full.tones_vertical = {{.omega = 1.0}};
  return full;
}

Scene without(Scene scene, const Group& group) {
  scene.*group.measured = false;
  if (group.measured == &Scene::position) scene.p_high = scene.p_low;
  if (group.measured == &Scene::attitude) scene.tilt_rms = 0.0;
  if (group.measured == &Scene::velocity) scene.nu_rms.head<3>().setZero();
  if (group.measured == &Scene::rates) scene.nu_rms.tail<3>().setZero();
  return scene;
}

/// Groups that were not measured, and without which the effect has no form.
std::vector<const Group*> needed_groups(const Effect& effect, const Scene& scene) {
  const Scene full = everything(effect, scene);
  std::vector<const Group*> needed;
  if (has_form(effect, scene) || !has_form(effect, full)) return needed;
  for (const Group& group : kGroups) {
    if (!(scene.*group.measured) && !has_form(effect, without(full, group))) needed.push_back(&group);
  }
  return needed;
}

}  // namespace

std::string why_not_asked(const Effect& effect, const Scene& scene) {
  std::vector<std::string> missing;
  for (const Group* group : needed_groups(effect, scene)) missing.emplace_back(group->name);
  if (!missing.empty()) return "not applicable: not measured: " + joined(missing);
  const Scene full = everything(effect, scene);
  if (has_form(effect, full)) return "not applicable: nothing in these runs could show it";
  if (effect.measures() && has_form(effect, without(without(full, kGroups[0]), kGroups[1])))
    return "not applicable: sensors are compared with each other";
  model::Vehicle vehicle = *scene.vehicle;
  Scene other = full;
  other.vehicle = &vehicle;
  if (!(vehicle.mass > 0.0)) {
    vehicle.mass = 1.0;
    if (has_form(effect, other)) return "not applicable: the vehicle file does not state the mass";
  }
  if (vehicle.thrusters.size() < 2) {
    vehicle.thrusters.resize(2);
    vehicle.allocation.setOnes(6, 2);
  }
  other.force_rms.setOnes(static_cast<Eigen::Index>(vehicle.thrusters.size()));
  other.input_is_wrench = false;
  if (has_form(effect, other)) return "not applicable: needs forces of single thrusters";
  vehicle.parameters.clear();
  vehicle.priors.clear();
  if (has_form(effect, other)) return "not applicable: the base model has it";
  vehicle.windage = 1.0;
  if (has_form(effect, other))
    return model::lives_by_flow(*scene.vehicle)
               ? "not applicable: the vehicle file states no windage"
               : "not applicable: the vehicle file states no rudder, fin, propeller, moved weight or windage";
  return "not applicable: acts along no simulated axis";
}

std::vector<NotMeasured> not_measured(const Scene& scene) {
  std::vector<NotMeasured> groups;
  for (const Group& group : kGroups) {
    if (scene.*group.measured) continue;
    groups.push_back({group.name, {}});
    for (const Effect* effect : model::all_effects()) {
      const std::vector<const Group*> needed = needed_groups(*effect, scene);
      if (std::ranges::find(needed, &group) != needed.end()) groups.back().cannot_be_asked.emplace_back(effect->name());
    }
    std::string& means = groups.back().means;
    means = not_measured_sentences({groups.back()}, *scene.vehicle);
    if (means.ends_with(' ')) means.pop_back();
  }
  return groups;
}

std::string not_measured_sentences(const std::vector<NotMeasured>& groups, const model::Vehicle& vehicle) {
  const auto& dof = vehicle.dof;
  std::string text;
  for (const Group& group : kGroups) {
    const auto found = std::ranges::find(groups, std::string(group.name), &NotMeasured::group);
    if (found == groups.end()) continue;
    const bool along = dof[0] || dof[1] || dof[2], turning = dof[3] || dof[4] || dof[5];
    const bool matters = group.measured == &Scene::rates ? turning : along || group.measured == &Scene::attitude;
    if (!matters && found->cannot_be_asked.empty()) continue;
    std::string name = group.name;
    name[0] = static_cast<char>(name[0] - 'a' + 'A');
    text += name + (group.measured == &Scene::rates ? " were" : " was") + " not measured: ";
    if (!found->cannot_be_asked.empty()) text += joined(found->cannot_be_asked) + " could not be asked";
    if (matters) text += (found->cannot_be_asked.empty() ? "" : ", and ") + std::string(group.unknown);
    text += ". ";
  }
  return text;
}

}  // namespace fathom::preflight
