// Process noise by likelihood: the densities under which the innovations of a recording are most probable.
#pragma once

#include "common/base/progress.hpp"
#include "common/estimation/online/kalman_settings.hpp"
#include "common/samples/recording.hpp"

namespace fathom::estimation {

/// Jerk and angular jerk (in the printed model also the velocity's walk), one after the other by factors, then again
/// by finer ones, on at most `longest` seconds of the recording. The measurement noises stay.
[[nodiscard]] KalmanSettings tune_process(const Recording& recording, KalmanSettings settings, double longest = 120.0,
                                          const Progress& progress = {});

}  // namespace fathom::estimation
