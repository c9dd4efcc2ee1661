// What drove the vehicle, on a trial's grid: thruster forces or the wrench, and the battery's voltage.
#pragma once

#include "common/estimation/reconstruct.hpp"

namespace fathom::estimation {

/// How the velocities of a trial came from faster ones: means of so many, so far apart.
struct Averaging {
  int samples{1};
  double step{};  ///< s
};

/// Fills input, held, told, input_step, input_part, input_is_wrench and voltage of a trial that has its times, in
/// seconds from `origin`. What inputs do from one time to the next is averaged as the velocities were. InputError when
/// nothing in the recording tells what drove the vehicle.
void add_input(const Recording& recording, Utime origin, const ThrusterCorrection& correction,
               const model::Vehicle& vehicle, const Averaging& averaging, Trial& trial);

}  // namespace fathom::estimation
