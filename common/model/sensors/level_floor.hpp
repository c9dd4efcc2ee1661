// A level floor as a camera of known place sees it (Karras et al., eqs. 1.25, 1.26): the scene's motion across the
// optical axis, and the distance of a point on it, as of a laser's dot.
#pragma once

#include <array>
#include <optional>

#include "common/model/sensors/tag_pose.hpp"

namespace fathom::model {

/// m from Co along the unit vector `along_C` to a level floor at depth `floor`; nothing when it looks away.
[[nodiscard]] std::optional<double> distance_to_floor(const KinematicPoint& point, double floor, const Pose& X_BC,
                                                      const Eigen::Vector3d& along_C);

/// Motion of the scene in the middle of the picture, the camera's rotation removed: z = -v_C / distance [1/s], of which
/// the third is minus the rate at which the picture grows. Nothing when the camera looks away from the floor.
[[nodiscard]] std::optional<std::array<Observation, 3>> observe_flow(const KinematicPoint& point, double floor,
                                                                     const Pose& X_BC, const Eigen::Vector3d& measured,
                                                                     const Eigen::Vector3d& variance);

/// A point of the floor seen at p_CL: how far it is along its line of sight [m]. Nothing when that leads away from the
/// floor.
[[nodiscard]] std::optional<Observation> observe_floor_point(const KinematicPoint& point, double floor,
                                                             const Pose& X_BC, const Eigen::Vector3d& p_CL,
                                                             double variance);

}  // namespace fathom::model
