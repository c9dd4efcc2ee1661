// One recording in seconds and arrays, cleaned of what is wrong by itself: glitches, freezes, repeats, gaps.
#pragma once

#include <string>
#include <vector>

#include "common/estimation/timeline.hpp"
#include "common/samples/diagnosis_result.hpp"
#include "common/samples/recording.hpp"

namespace fathom::estimation {

struct RunSignals {
  std::string name;
  Utime origin{};         ///< first time stamp of any stream
  PoseSeries pose;        ///< motion capture, on its own clock
  PoseSeries attitude;    ///< AHRS attitude (no position)
  Series gyro;            ///< rad/s
  Series specific_force;  ///< m/s^2
  Series dvl;             ///< m/s, fresh and valid samples only
  Series depth;           ///< (0, 0, z) m
};

/// The attitude that rates are compared with: motion capture, else AHRS.
[[nodiscard]] const PoseSeries& reference_pose(const RunSignals& run);
/// Of the streams that make a trial; zero when all are empty.
[[nodiscard]] Utime first_stamp(const Recording& recording);
/// Reads all streams; appends what it refuses to believe to `findings`.
[[nodiscard]] RunSignals read_signals(const Recording& recording, std::vector<ConsistencyFinding>& findings);

}  // namespace fathom::estimation
