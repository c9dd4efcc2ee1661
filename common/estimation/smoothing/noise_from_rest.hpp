// Measurement noise from a stretch in which the vehicle stands still (Pereira and Duncan characterised theirs from
// stationary trials data): what the sensors say then is noise.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "common/estimation/online/kalman_settings.hpp"
#include "common/samples/recording.hpp"

namespace fathom::estimation {

struct Rest {
  Utime from{}, to{};
};

/// The longest stretch, `shortest` seconds at least, in which no instrument moves by more than its own white noise
/// explains: means of gyro and accelerometer stay, what tells place, depth, range or attitude goes nowhere, and what
/// tells velocity tells none. Nothing without one, or without an inertial package: a vehicle that drifts has quiet
/// gyros and accelerometers too.
[[nodiscard]] std::optional<Rest> find_rest(const Recording& recording, double shortest = 4.0);

/// `settings` with the noises of every instrument that gave enough samples during rest; without a rest as they were. A
/// line of `notes` says which.
[[nodiscard]] KalmanSettings noise_from_rest(const Recording& recording, KalmanSettings settings,
                                             std::vector<std::string>& notes);

}  // namespace fathom::estimation
