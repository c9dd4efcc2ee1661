// What the numbers of one vehicle say about each other: mass against the hull's volume and the thrust, moments of
// inertia against both. Each alone may be possible and all together not, as 13 g for a craft of 24 kg.
#pragma once

#include <string>

#include "common/base/config.hpp"
#include "common/model/vehicle.hpp"

namespace fathom::model {

/// Most that all actuators of a vehicle push with together [N]; 0 where its file does not say.
[[nodiscard]] double largest_push(const Vehicle& vehicle);

/// InputError with the line of 'mass' or 'inertia' where no craft is so light, heavy, strong or slow to turn as these
/// numbers make it. What the file leaves out is not asked.
void check_proportions(const Config& config, const Vehicle& vehicle);

/// The same of a moment of inertia, the water that turns with the hull included [kg m^2], about axis 0, 1 or 2;
/// `key` is its name and `line` where it stands in `section`.
void check_moment(const Config& section, const std::string& line, const std::string& key, int axis, double moment,
                  const Vehicle& vehicle);

}  // namespace fathom::model
