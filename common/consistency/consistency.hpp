// Checks the sensors of one vehicle's recordings against each other before anything is fitted, names what disagrees,
// and says how to correct it. The motion capture, where there is one, is the reference; the on-board clock is the
// clock.
#pragma once

#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "common/base/statistics.hpp"
#include "common/consistency/pairs/pair.hpp"
#include "common/estimation/corrections.hpp"
#include "common/estimation/run_signals.hpp"
#include "common/model/vehicle.hpp"
#include "common/samples/diagnosis_result.hpp"
#include "common/samples/recording.hpp"

namespace fathom::consistency {

using estimation::block_average;
using estimation::make_continuous;
using estimation::QuaternionForm;
using estimation::read_signals;
using estimation::reference_pose;
using estimation::RunSignals;
using estimation::ThrusterCorrection;

struct ConsistencyResult {
  std::vector<ConsistencyFinding> findings;
  std::vector<Corrections> corrections;     ///< one per recording, in their order
  std::map<std::string, PairResult> pairs;  ///< "gyro", "dvl", "accelerometer": numbers behind the findings
  Pooled distance;                          ///< the position's way over the velocity log's, after what was corrected
  double distance_limit{};                  ///< sigmas of it that count as significant
  /// By which the position has been divided and by which the velocity log may have to be multiplied instead; nothing
  /// where no such factor was found, or kinematics tells which is wrong.
  std::optional<double> either_scale{};
};

[[nodiscard]] ConsistencyResult check_consistency(std::span<const Recording> recordings);

/// Compares the logged wrench with the one that the vehicle file makes of the commands; adds to `result`.
void check_thrusters(std::span<const Recording> recordings, const model::Vehicle& vehicle, ConsistencyResult& result);

/// Sign, scale and delay of the depth sensor; the offset (the water line) is nobody's fault.
[[nodiscard]] std::vector<ConsistencyFinding> compare_depth(const RunSignals& run, const PoseSeries& pose);

/// An axis of gyro or DVL that is far noisier than the other two.
[[nodiscard]] std::vector<ConsistencyFinding> compare_noise(std::span<const RunSignals> runs);

/// The world's vertical against the direction in which the vehicle hangs; one pose series per recording.
[[nodiscard]] std::vector<ConsistencyFinding> compare_with_vertical(const std::string& signal,
                                                                    std::span<const std::string> names,
                                                                    std::span<const PoseSeries> poses);

/// Gyro or DVL corrected and on the clock of the reference pose.
[[nodiscard]] Series on_reference_clock(const SensorFault& fault, const Series& logged);

}  // namespace fathom::consistency
