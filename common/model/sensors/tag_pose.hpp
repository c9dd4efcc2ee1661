// A fiducial tag of known place, seen by a camera of known place: its pose in the camera becomes a pose of the hull.
#pragma once

#include <array>

#include "common/model/sensors/kinematic_point.hpp"

namespace fathom::model {

/// A pose: origin and turn of one frame in another.
struct Pose {
  Eigen::Vector3d p{Eigen::Vector3d::Zero()};
  Eigen::Quaterniond q{Eigen::Quaterniond::Identity()};
};

/// X_WB = X_WT X_CT^-1 X_BC^-1.
[[nodiscard]] Pose body_from_tag(const Pose& X_WT, const Pose& X_CT, const Pose& X_BC);

/// Tag's place [m] in the camera (three rows) and attitude [rad in B] (three rows). The place along the line of sight
/// is told by the tag's size alone and gets the larger variance `along`; across it `across`.
[[nodiscard]] std::array<Observation, 6> observe_tag(const KinematicPoint& point, const Pose& X_WT, const Pose& X_BC,
                                                     const Pose& X_CT, double across, double along, double attitude);

}  // namespace fathom::model
