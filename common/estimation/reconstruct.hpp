// One recording, corrected, on one clock and one uniform grid: the reference that models are fitted to and judged by.
#pragma once

#include "common/estimation/corrections.hpp"
#include "common/model/vehicle.hpp"
#include "common/samples/recording.hpp"
#include "common/samples/trial.hpp"

namespace fathom::estimation {

/// Velocity is DVL or derivative of position, whichever is less noisy (both, weighted, when alike); rates likewise. The
/// derivative's gain at 1 Hz is within 3 % of one. The other signal bridges gaps. Attitude is
/// averaged along the rates where they are a gyro's alone. InputError without any motion or
/// input.
[[nodiscard]] Trial reconstruct(const Recording& recording, const Corrections& corrections,
                                const model::Vehicle& vehicle);

}  // namespace fathom::estimation
