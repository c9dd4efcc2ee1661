// A recording after the corrections of the sensor check, stream by stream: for estimators that know nothing of them.
#pragma once

#include "common/estimation/corrections.hpp"
#include "common/samples/recording.hpp"

namespace fathom::estimation {

/// Stamps on the common clock; gyro, accelerometer, velocity log and pose without the faults that were found; doubtful
/// poses marked invalid. The other streams are as they were.
[[nodiscard]] Recording corrected(Recording recording, const Corrections& corrections);

}  // namespace fathom::estimation
