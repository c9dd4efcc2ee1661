// A vehicle file that has been read already, as one that a process tells of.
#pragma once

#include "common/base/config.hpp"
#include "common/model/vehicle.hpp"

namespace fathom::model {

/// As Vehicle::load() makes it of the file; InputError with file and line.
[[nodiscard]] Vehicle vehicle_from(const Config& config);

}  // namespace fathom::model
