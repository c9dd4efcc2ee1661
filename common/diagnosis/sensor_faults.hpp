// Faults of sensors that kinematics has found and corrected are causes too: they take their place among the effects.
#pragma once

#include <span>
#include <vector>

#include "common/samples/diagnosis_result.hpp"

namespace fathom::diagnosis {

/// The effects that findings about all recordings amount to, each with its numbers.
[[nodiscard]] std::vector<EffectFound> sensor_faults(std::span<const ConsistencyFinding> findings);

/// Reads `result.consistency`; puts sensor_latency, sensor_scale and lever_arm, where a finding was corrected in all
/// recordings, before the effects that forces have shown, and says so in verdict and paragraph.
void adopt_sensor_faults(DiagnosisResult& result);

}  // namespace fathom::diagnosis
