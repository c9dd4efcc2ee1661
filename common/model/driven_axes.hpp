// Which of a vehicle's free motions its thrusters can produce by themselves. One that they cannot is normal: a boat's
// sway follows its surge and yaw, a torpedo's heave its pitch.
#pragma once

#include <array>
#include <string>

#include "common/model/vehicle.hpp"

namespace fathom::model {

/// Order surge sway heave roll pitch yaw; false outside `dof`. All of `dof` where the file names no thrusters.
[[nodiscard]] std::array<bool, 6> driven_axes(const Vehicle& vehicle);
/// Some actuator has a part along that axis, alone or not; true where the file names no thrusters.
[[nodiscard]] bool pushed_along(const Vehicle& vehicle, Eigen::Index axis);
/// "NAME: sway moves freely, without thrust of its own (...)"; empty when every simulated axis is driven.
[[nodiscard]] std::string undriven_note(const Vehicle& vehicle);

}  // namespace fathom::model
