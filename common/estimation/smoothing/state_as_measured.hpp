// Logs of live trials hold no motion capture, but what the estimator made of all aids. Where nothing better was
// recorded, that is what models are fitted to.
#pragma once

#include "common/samples/recording.hpp"

namespace fathom::estimation {

/// STATE as pose and, without a velocity log, as velocity too, which is then no witness against the pose; nor is the
/// accelerometer any more. False, and nothing done, when the recording has motion capture or no state.
bool take_state_as_measured(Recording& recording);

}  // namespace fathom::estimation
