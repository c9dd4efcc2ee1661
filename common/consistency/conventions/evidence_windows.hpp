// What a second of one recording holds of the kinematic relations, for one way to read the attitude: everything else
// that a reading may change is linear in it.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "common/consistency/conventions/reading.hpp"
#include "common/estimation/timeline.hpp"

namespace fathom::consistency {

/// sum over the window of w R_ij x_l; rows i + 3 j.
using Tensor = Eigen::Matrix<double, 9, 3>;

struct EvidenceWindow {
  bool has_velocity{}, has_rates{}, has_force{}, has_depth{};
  Eigen::Vector3d moved{Eigen::Vector3d::Zero()};     // m, of the position
  Eigen::Vector3d straight{Eigen::Vector3d::Zero()};  // integral of the velocity as it is, m
  double deeper{};                                    // m, by the depth sensor
  Tensor velocity{Tensor::Zero()}, rates{Tensor::Zero()}, force{Tensor::Zero()};
  Eigen::Matrix3d turned{Eigen::Matrix3d::Zero()};       // R(end) - R(begin)
  Eigen::Matrix3d mean{Eigen::Matrix3d::Zero()};         // integral of R, s
  Eigen::Matrix3d euler_cross{Eigen::Matrix3d::Zero()};  // integral of R [body rates of the logged Euler rates]x
  double length{};                                       // s
};

/// Streams of one recording as read. Empty: not recorded; `depth` holds (0, 0, z).
struct EvidenceStreams {
  const estimation::PoseSeries& pose;
  const estimation::Series &velocity, &rates, &force, &depth;
  double velocity_delay{}, rates_delay{};  ///< s, by what no turn of axes changes: speeds
};

/// Finds by how much the stamps of velocity and rates lag behind the pose's.
void find_delays(EvidenceStreams& streams);

/// Windows of about a second, as many as tell, spread over the recording; none without attitude.
[[nodiscard]] std::vector<EvidenceWindow> evidence_windows(const EvidenceStreams& streams, const Reading& reading);

}  // namespace fathom::consistency
