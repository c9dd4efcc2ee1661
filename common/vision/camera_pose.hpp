// Pose of a camera from points of known place: robust least squares on pixels, its covariance, and the second pose that
// a plane seen from afar allows.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "common/base/spatial.hpp"
#include "common/vision/projection.hpp"

namespace fathom::vision {

/// A point of the world and its pixel.
struct Correspondence {
  Eigen::Vector3d p_W{Eigen::Vector3d::Zero()};
  Eigen::Vector2d pixel{Eigen::Vector2d::Zero()};
};

/// Where the camera is.
struct Pose {
  Eigen::Vector3d p_WC{Eigen::Vector3d::Zero()};
  Eigen::Matrix3d R_WC{Eigen::Matrix3d::Identity()};
};

struct FittedPose {
  Pose pose;
  double cost{};                           ///< px^2, sum of squares, robust
  double rms{};                            ///< px, root mean square of the distance per point
  Matrix6d information{Matrix6d::Zero()};  ///< 1/px^2: of a shift [m, in W] and a turn [rad, in C] of the camera
};

/// Improves a pose; nothing when points fall behind the camera or it does not converge. `scale` [px]: residuals beyond
/// it pull no more than linearly; 0: all count squared.
[[nodiscard]] std::optional<FittedPose> fit_pose(const Projection& projection,
                                                 const std::vector<Correspondence>& points, const Pose& start,
                                                 double scale);

/// Poses to begin with, from four or more points of one plane; the better one first. Empty when there is none.
[[nodiscard]] std::vector<Pose> planar_poses(const Projection& projection, const std::vector<Correspondence>& points);

/// The pose with the plane's normal mirrored at the line of sight to the points' middle: where a plane's second
/// solution begins. `normal_W` is the plane's.
[[nodiscard]] Pose mirrored(const Pose& pose, const std::vector<Correspondence>& points,
                            const Eigen::Vector3d& normal_W);

}  // namespace fathom::vision
