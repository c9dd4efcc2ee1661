// Faults of sensors that kinematics has found and corrected are causes too: they take their place among the effects.
#pragma once

#include <span>
#include <vector>

#include "common/samples/diagnosis_result.hpp"

namespace fathom::preflight {

/// sensor_latency, sensor_scale and lever_arm where a finding was corrected in all recordings, each with its numbers.
[[nodiscard]] std::vector<EffectFound> sensor_faults(std::span<const ConsistencyFinding> findings);

/// Whether an accepted delay of all thrusters is what the gyro lags the pose by, within three standard deviations of
/// both, where thrusters were taken to be on the gyro's clock.
[[nodiscard]] bool thrust_as_late_as_gyro(const DiagnosisResult& result, std::span<const ConsistencyFinding> findings);

}  // namespace fathom::preflight
