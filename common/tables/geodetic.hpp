// Latitude and longitude to north, east and down of the run's first fix.
#pragma once

#include <Eigen/Core>
#include <string>

#include "common/tables/readers.hpp"

namespace fathom::tables {

/// Where north, east and down are counted from. Radii of curvature of the WGS84 ellipsoid at the origin: within
/// 1 cm over 1 km, below 1 m over 10 km, at latitudes under 70 deg.
struct GeodeticOrigin {
  double latitude{}, longitude{};  ///< rad
  double height{};                 ///< m, up
  /// The first row that holds a position; zeros when none does.
  [[nodiscard]] static GeodeticOrigin first_of(const Group& position, const Rows& rows);
  /// m. `position`: latitude, longitude, height.
  [[nodiscard]] Eigen::Vector3d north_east_down(const Group& position, std::size_t row) const;
  [[nodiscard]] std::string note() const;
};

}  // namespace fathom::tables
