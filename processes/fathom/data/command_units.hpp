// Whether a map's commands are of the kinds that the vehicle file's actuators take: degrees of a rudder where a shaft's
// speed stands would be numbers like any others.
#pragma once

#include <string>

#include "common/model/vehicle.hpp"

namespace fathom::tool {

/// InputError with the line of the map where the number of `inputs`, or the kind of a unit, is not the vehicle's. An
/// empty path, and a map without `inputs`, are right.
void check_command_units(const std::string& map, const model::Vehicle& vehicle);

}  // namespace fathom::tool
