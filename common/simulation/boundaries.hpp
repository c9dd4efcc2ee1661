// Walls, floor and surface of a site as planes, and how far a ray goes before it meets one.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "common/model/site.hpp"

namespace fathom::simulation {

enum class Boundary { kFloor, kWall, kSurface };

/// Points p of the water have n . p >= offset.
struct Plane {
  Eigen::Vector3d n{Eigen::Vector3d::Zero()};  ///< unit, into the water, in W
  double offset{};                             ///< m
  Boundary kind{};
};

/// The solid ones: floor and walls.
[[nodiscard]] std::vector<Plane> solid_planes(const model::Site& site);
/// From `p_W` along the unit vector `direction_W` to the first solid plane [m]; infinite when the ray meets none.
[[nodiscard]] double distance_along(const model::Site& site, const Eigen::Vector3d& p_W,
                                    const Eigen::Vector3d& direction_W);

}  // namespace fathom::simulation
