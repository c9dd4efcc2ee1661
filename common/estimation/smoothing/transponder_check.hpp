// Does every transponder stand where the file says? One that contradicts the others is found and left out.
#pragma once

#include <string>
#include <vector>

#include "common/estimation/online/kalman_settings.hpp"
#include "common/samples/recording.hpp"

namespace fathom::estimation {

/// The settings with at most all but three transponders switched off, each named in one line of `notes`. What cannot be
/// blamed on one of them is said too.
[[nodiscard]] KalmanSettings without_wrong_transponders(const Recording& recording, KalmanSettings settings,
                                                        std::vector<std::string>& notes);

}  // namespace fathom::estimation
