#include "processes/fathom/data/command_units.hpp"

#include <algorithm>

#include "common/base/error.hpp"
#include "common/base/units.hpp"
#include "common/tables/mapped_streams.hpp"

namespace fathom::tool {
namespace {

/// What an actuator's command is measured in.
const char* unit_of(const model::Thruster& actuator, const model::Vehicle& vehicle) {
  switch (actuator.command) {
    case model::CommandKind::kShaftSpeed:
      return "rad/s";
    case model::CommandKind::kFinAngle:
    case model::CommandKind::kAzimuthAngle:
      return "rad";
    case model::CommandKind::kWeight:
      if (actuator.weight->kind == model::Weight::Kind::kSlid) return "m";
      if (actuator.weight->kind == model::Weight::Kind::kTurned) return "rad";
      return actuator.weight->per_command < 0.0 ? "m^3" : "kg";  // volume lifts, water taken in does not
    case model::CommandKind::kAzimuthForce:
      return "N";
    default:
      return vehicle.curve.empty() ? "N" : "us";
  }
}

bool fits(const std::string& unit, const std::string& wanted) {
  try {
    static_cast<void>(unit_factor(unit, wanted));
    return true;
  } catch (const InputError&) {
    return false;
  }
}

}  // namespace

void check_command_units(const std::string& map, const model::Vehicle& vehicle) {
  if (map.empty() || !vehicle.has_thrusters()) return;
  for (const tables::InputColumns& inputs : tables::inputs_of_map(map)) {
    const std::vector<tables::Column>& columns = inputs.group.columns;
    std::string wanted;
    bool right = columns.size() == vehicle.thrusters.size();
    for (std::size_t i = 0; i < vehicle.thrusters.size(); ++i) {
      const std::string unit = unit_of(vehicle.thrusters[i], vehicle);
      right = right && fits(inputs.units[i], unit);
      wanted += (wanted.empty() ? "" : ", ") + vehicle.thrusters[i].name + " in " + unit;
    }
    if (!right)
      throw InputError(columns.front().where + ": 'inputs' names " + std::to_string(columns.size()) +
                       " commands whose units are not those of the vehicle's actuators; " + vehicle.name +
                       " has: " + wanted + " (or another unit of that kind), in this order");
  }
}

}  // namespace fathom::tool
