// A whole recorded trial through the Kalman filter and back through the smoother. Memory stays small: the filter runs a
// second time, stretch by stretch, for what the way back needs.
#pragma once

#include <string>
#include <vector>

#include "common/base/progress.hpp"
#include "common/estimation/online/kinematic_estimator.hpp"
#include "common/samples/recording.hpp"

namespace fathom::estimation {

struct SmoothedTrial {
  std::vector<StateEstimate> filtered;  ///< where they were asked for
  std::vector<Eigen::Vector3f> apart;   ///< m, of the filter's place from the smoother's, along the axes of W
  std::vector<SmoothedState> smoothed;  ///< at the same times
  std::vector<InnovationStatistics> statistics;
  std::vector<std::string> notes;  ///< one line each: what was wrong and what was done about it
  double likelihood{};             ///< log p of all innovations
  model::KinematicVector biases{model::KinematicVector::Zero()};  ///< smoothed, at the end of the run
};

/// Asked for every instant besides the output: full numbers, for tests and tables, and the attitude, about which the
/// angles' part of P is a turn in B (of the printed model: roll, pitch, yaw). Instants come newest first.
using SmoothedVisit =
    std::function<void(Utime, const Eigen::VectorXd& x, const Eigen::Matrix3d& R_WB, const Eigen::MatrixXd& P)>;

/// Estimates at the times of the inertial package (of the pose capture without one). InputError in one line when the
/// run cannot begin, holds nothing to estimate from, or loses its attitude.
[[nodiscard]] SmoothedTrial smooth(const Recording& recording, const KalmanSettings& settings,
                                   const SmoothedVisit& visit = nullptr, const Progress& progress = {},
                                   bool keep_filtered = true);

/// Whether anything in the recording tells where the vehicle is, with what is known of the instruments.
[[nodiscard]] bool tells_position(const Recording& recording, const KalmanSettings& settings);

/// The filter alone: how every instrument fared.
[[nodiscard]] std::vector<InnovationStatistics> innovations(const Recording& recording, const KalmanSettings& settings);

/// log p of all innovations, filter alone.
[[nodiscard]] double likelihood(const Recording& recording, const KalmanSettings& settings);

}  // namespace fathom::estimation
