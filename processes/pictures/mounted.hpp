// What a vehicle file says of one of its cameras.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>

#include "common/model/mounts.hpp"

namespace fathom::pictures {

struct Mounted {
  std::string name;
  std::optional<model::Lens> lens;  ///< nothing without a vehicle file
  std::optional<model::LaserMount> laser;
  Eigen::Matrix3d R_BC{Eigen::Matrix3d::Identity()};
};

/// `vehicle`: path, may be empty; `camera`: its name, empty: the first. InputError when there is no such camera.
[[nodiscard]] Mounted mounted(const std::string& vehicle, const std::string& camera);

}  // namespace fathom::pictures
