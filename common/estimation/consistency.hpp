// Checks the sensors of one vehicle's recordings against each other before anything is fitted, names what disagrees,
// and says how to correct it. The motion capture, where there is one, is the reference; the on-board clock is the
// clock.
#pragma once

#include <map>
#include <span>
#include <string>
#include <vector>

#include "common/estimation/compatibility.hpp"
#include "common/estimation/run_signals.hpp"
#include "common/model/vehicle.hpp"
#include "common/samples/diagnosis_result.hpp"
#include "common/samples/recording.hpp"

namespace fathom::estimation {

/// How the four numbers of an attitude were meant.
enum class QuaternionForm { kAsRead, kInverse, kScalarLast, kScalarLastInverse };

/// How the logged wrench follows from the commands: tau = scale (V / V_curve)^exponent allocation curve(pwm).
struct ThrusterCorrection {
  bool use_commands{false};  ///< false: the logged forces or the logged wrench are used as they are
  double scale{1.0};
  double exponent{};  ///< of the battery's voltage over the curve's
};

/// What is done to one recording before it is used.
struct Corrections {
  QuaternionForm quaternion{QuaternionForm::kAsRead};
  Eigen::Matrix3d attitude_axes{Eigen::Matrix3d::Identity()};  ///< R_WB := Rz(heading) R_WB attitude_axes
  double heading{};                                            ///< rad
  Eigen::Matrix3d position_axes{Eigen::Matrix3d::Identity()};  ///< p_WB := scale position_axes p_WB
  double position_scale{1.0};
  SensorFault gyro, dvl, accelerometer;
  double pose_shift{}, dvl_shift{}, gyro_shift{};  ///< s, added to the stamps to reach the common clock
  std::vector<double> doubtful_pose;  ///< s on the pose's clock: the gyro contradicts the pose around these
  ThrusterCorrection thrusters;
};

struct ConsistencyResult {
  std::vector<ConsistencyFinding> findings;
  std::vector<Corrections> corrections;     ///< one per recording, in their order
  std::map<std::string, PairResult> pairs;  ///< "gyro", "dvl", "accelerometer": numbers behind the findings
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

/// The pose after corrections of form, axes, heading and unit; on its own clock.
void correct_pose(const Corrections& corrections, PoseSeries& pose);
/// The attitude that rates are compared with: motion capture, else AHRS.
[[nodiscard]] const PoseSeries& reference_pose(const RunSignals& run);
/// Gyro or DVL corrected and on the clock of the reference pose.
[[nodiscard]] Series on_reference_clock(const SensorFault& fault, const Series& logged);

}  // namespace fathom::estimation
