#include "common/exports/models/craft.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "common/base/error.hpp"
#include "common/model/parameters.hpp"
#include "common/report/text.hpp"

namespace fathom::exports {
namespace {

constexpr double kRigidPart = 0.5;  // of a rotation's inertia, where the vehicle's file does not say

double value(const std::vector<NamedValue>& all, std::string_view name, double otherwise) {
  const auto found = std::ranges::find(all, name, &NamedValue::name);
  return found == all.end() || !std::isfinite(found->value) ? otherwise : found->value;
}

/// Lumped inertia on each axis: as identified; on axes that the diagnosis did not simulate, the vehicle's prior.
Vector6d lumped(const result::Stored& stored, const model::Vehicle& vehicle, std::vector<std::string>& notes) {
  Vector6d inertia = Vector6d::Zero();
  for (std::size_t axis = 0; axis < 6; ++axis) {
    const auto parameter = model::base_parameters()[axis];
    const auto k = static_cast<Eigen::Index>(axis);
    inertia[k] = value(stored.result.parameters_after, model::name(parameter), 0.0);
    if (inertia[k] > 0.0) continue;
    const char* motion = report::kAxes[axis].name;
    inertia[k] = axis < 3 ? vehicle.mass : vehicle.inertia[static_cast<Eigen::Index>(axis - 3)];
    if (!(inertia[k] > 0.0))
      throw InputError(stored.path + ": " + motion + " was not identified, and the vehicle's file states no " +
                       (axis < 3 ? "mass" : "inertia") + "; add it there ('" + (axis < 3 ? "mass" : "inertia") + "')");
    notes.push_back(std::string{motion} +
                    " was not identified: rigid inertia of the vehicle's file, no added mass, no drag");
  }
  return inertia;
}

void put_effects(const result::Stored& stored, std::vector<std::string>& notes) {
  if (stored.result.correction && stored.result.correction->adopted)
    notes.push_back("not in this file: the learned correction ('correction' in " + stored.path + ")");
  const auto lacks = [&](const char* what, const auto& effect) {
    std::string note =
        std::string{"not in this file: the "} + what + " " + report::effect_title(effect.name, effect.variant);
    for (std::size_t i = 0; i < effect.parameters.size(); ++i) {
      note += (i == 0 ? " (" : ", ") + effect.parameters[i].name + " = " + report::with_interval(effect.parameters[i]);
    }
    notes.push_back(note + (effect.parameters.empty() ? "" : ")"));
  };
  for (const EffectFound& effect : stored.result.effects) {
    if (effect.accepted) lacks("effect", effect);
  }
  for (const StandIn& stand_in : stored.result.stand_ins) {
    if (stand_in.in_model) lacks("stand-in", stand_in);
  }
}

}  // namespace

Craft craft_of(const result::Stored& stored, const model::Vehicle& vehicle) {
  const DiagnosisResult& result = stored.result;
  if (result.parameters_after.empty())
    throw InputError(stored.path + ": holds no numbers (verdict '" + result.verdict +
                     "'): there is no model to export");
  Craft craft;
  craft.name = vehicle.name;
  if (result.verdict == "unexplained" || result.verdict == "ambiguous")
    craft.notes.push_back("the diagnosis was '" + result.verdict +
                          "': something acts on the vehicle that this model lacks");
  if (result.verdict == "no_model")
    craft.notes.emplace_back("the diagnosis was 'no_model': along some axes the model does not follow its thrust");
  const Vector6d inertia = lumped(stored, vehicle, craft.notes);
  const double least = inertia.head<3>().minCoeff();
  craft.mass = vehicle.mass > 0.0 ? std::min(vehicle.mass, least) : least;
  if (!(vehicle.mass > 0.0)) {
    craft.notes.emplace_back("the vehicle's file states no mass: all that every direction shares is written as rigid");
  } else if (vehicle.mass > least) {
    craft.notes.push_back("identified inertia " + report::number(least) + " kg is less than the vehicle's mass " +
                          report::number(vehicle.mass) + " kg, which is not physical: the smaller is written as rigid");
  }
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    const double known = vehicle.inertia[axis], total = inertia[3 + axis];
    craft.inertia[axis] = known > 0.0 && known <= total ? known : kRigidPart * total;
    craft.added[axis] = inertia[axis] - craft.mass;
    craft.added[3 + axis] = total - craft.inertia[axis];
  }
  if (!(vehicle.inertia.minCoeff() > 0.0))
    craft.notes.emplace_back(
        "how much of each moment of inertia is the water's is not known: half is written as added; in still water only "
        "the sum matters");
  for (std::size_t axis = 0; axis < 6; ++axis) {
    const auto k = static_cast<Eigen::Index>(axis);
    craft.linear[k] = value(result.parameters_after, model::name(model::base_parameters()[6 + axis]), 0.0);
    craft.quadratic[k] = value(result.parameters_after, model::name(model::base_parameters()[12 + axis]), 0.0);
    if (craft.linear[k] > 0.0 || craft.quadratic[k] > 0.0)
      craft.notes.push_back("drag of " + std::string{report::kAxes[axis].name} +
                            " has a term that drives, not brakes: " + "other simulators may diverge");
  }
  craft.density = vehicle.water_density;
  craft.weight = craft.mass * Craft::kGravity;
  craft.buoyancy = craft.weight - value(result.parameters_after, "W-B", 0.0);
  if (!(craft.buoyancy > 0.0))
    throw InputError(stored.path + ": W-B is no less than the vehicle's weight: nothing would float; check its 'mass'");
  // G = r_G W - r_B B with the centre of mass at Bo.
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    constexpr std::array kNames{"G_x", "G_y", "G_z"};
    craft.p_BB[axis] = -value(result.parameters_after, kNames[static_cast<std::size_t>(axis)], 0.0) / craft.buoyancy;
  }
  craft.thrusters = vehicle.thrusters;
  put_effects(stored, craft.notes);
  if (craft.density <= 0.0) throw InputError("the vehicle's file states no water_density, and a volume needs one");
  return craft;
}

}  // namespace fathom::exports
