// The camera's shift over its distance to a plane, from features whose rotation is taken out: iterated, reweighted
// least squares with Tukey's weights.
#pragma once

#include <Eigen/Core>
#include <vector>

namespace fathom::vision {

/// One feature in normalized coordinates of the first picture: d = s (-tau_xy + y tau_z).
struct FlowRow {
  Eigen::Vector2d d, y;
  double s{};
};

struct PlaneFlow {
  Eigen::Vector3d tau{Eigen::Vector3d::Zero()};
  Eigen::Matrix3d covariance{Eigen::Matrix3d::Zero()};
  std::vector<bool> agrees;
  int n_agreed{};
  double spread{};  ///< standard deviation of those that agree, per axis
};

[[nodiscard]] PlaneFlow fit_plane_flow(const std::vector<FlowRow>& rows);

/// By how much tau errs when the rotation that was taken out errs by a turn [rad, axes of the first picture's camera].
[[nodiscard]] Eigen::Matrix3d error_by_rotation(const std::vector<FlowRow>& rows, const PlaneFlow& fitted);

}  // namespace fathom::vision
