// What drove the vehicle, on a trial's grid: thruster forces or the wrench, and the battery's voltage.
#pragma once

#include "common/estimation/reconstruct.hpp"

namespace fathom::estimation {

/// Fills input, held, told, input_step, input_is_wrench and voltage of a trial that has its times, in seconds from
/// `origin`. InputError when nothing in the recording tells what drove the vehicle.
void add_input(const Recording& recording, Utime origin, const ThrusterCorrection& correction,
               const model::Vehicle& vehicle, Trial& trial);

}  // namespace fathom::estimation
