// VEHICLE to its sample, and back. Include the message's own header to use the pair.
#pragma once

#include <optional>

#include "common/samples/vehicle_condition.hpp"

namespace fathom_lcm {
class vehicle_condition_t;
}

namespace fathom::wire {

/// Nothing when a length is wrong or a number is not finite.
[[nodiscard]] std::optional<VehicleCondition> decode(const fathom_lcm::vehicle_condition_t& message);
[[nodiscard]] fathom_lcm::vehicle_condition_t encode(const VehicleCondition& sample);

}  // namespace fathom::wire
