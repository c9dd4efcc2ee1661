#include "common/simulation/boundaries.hpp"

#include <algorithm>
#include <cmath>

namespace fathom::simulation {

std::vector<Plane> solid_planes(const model::Site& site) {
  std::vector<Plane> planes;
  const auto add = [&](const Eigen::Vector3d& n, double offset, Boundary kind) {
    if (std::isfinite(offset)) planes.push_back({n, offset, kind});
  };
  add(-Eigen::Vector3d::UnitZ(), -site.floor, Boundary::kFloor);
  add(-Eigen::Vector3d::UnitX(), -site.north, Boundary::kWall);
  add(Eigen::Vector3d::UnitX(), site.south, Boundary::kWall);
  add(-Eigen::Vector3d::UnitY(), -site.east, Boundary::kWall);
  add(Eigen::Vector3d::UnitY(), site.west, Boundary::kWall);
  return planes;
}

double distance_along(const model::Site& site, const Eigen::Vector3d& p_W, const Eigen::Vector3d& direction_W) {
  double nearest = model::Site::kNone;
  const auto meet = [&](double boundary, double position, double slope) {
    if (slope != 0.0 && std::isfinite(boundary)) {
      const double distance = (boundary - position) / slope;
      if (distance >= 0.0) nearest = std::min(nearest, distance);
    }
  };
  if (direction_W.z() > 0.0) meet(site.floor, p_W.z(), direction_W.z());
  meet(direction_W.x() > 0.0 ? site.north : site.south, p_W.x(), direction_W.x());
  meet(direction_W.y() > 0.0 ? site.east : site.west, p_W.y(), direction_W.y());
  return nearest;
}

}  // namespace fathom::simulation
