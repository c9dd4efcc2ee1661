// An axis of a sensor that says one number throughout while the pose shows motion along it: a column of zeros, a plug
// that was not in.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "common/samples/diagnosis_result.hpp"
#include "common/samples/recording.hpp"

namespace fathom::consistency {

/// Sets aside, recording by recording, rates or velocities of which an axis in `dof` (order u v w p q r) is dead: the
/// pose tells them then. One finding ("dead") for each such axis.
[[nodiscard]] std::vector<ConsistencyFinding> set_aside_dead_axes(std::span<Recording> recordings,
                                                                  const std::array<bool, 6>& dof);

}  // namespace fathom::consistency
