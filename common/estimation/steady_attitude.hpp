// A trial's attitude with its white noise averaged out. Neighbours are carried along the measured rates to the sample
// in the middle, so that the mean follows any motion; what a predicted trajectory begins with, and the level that a
// restoring moment is measured against, are then as good as gyro and attitude together allow.
#pragma once

#include "common/samples/trial.hpp"

namespace fathom::estimation {

/// Averages over as many samples on each side as the noise of attitude (found by comparison with the rates) and of
/// rates (`trial.nu_sigma`) make best, half a second at most, up to the nearest gap: errors of the rates that last
/// cancel between the sides. For rates that were measured, not derived from this attitude.
void steady_attitude(Trial& trial);

}  // namespace fathom::estimation
