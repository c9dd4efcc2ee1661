#include "common/tables/geodetic.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>

#include "common/base/units.hpp"

namespace fathom::tables {
namespace {

constexpr double kSemiMajor = 6378137.0;             // m, WGS84
constexpr double kFlattening = 1.0 / 298.257223563;  // WGS84

}  // namespace

GeodeticOrigin GeodeticOrigin::first_of(const Group& position, const Rows& rows) {
  const auto row = std::ranges::find_if(rows.index, [&](std::size_t one) { return position.complete(one); });
  if (row == rows.index.end()) return {};
  return {position.scalar_of(0, *row), position.scalar_of(1, *row), position.raw(2, *row)};
}

Eigen::Vector3d GeodeticOrigin::north_east_down(const Group& position, std::size_t row) const {
  constexpr double kEccentricitySquared = kFlattening * (2.0 - kFlattening);
  const double sine = std::sin(latitude), root = std::sqrt(1.0 - kEccentricitySquared * sine * sine);
  const double normal = kSemiMajor / root;                                        // radius of the prime vertical
  const double meridian = normal * (1.0 - kEccentricitySquared) / (root * root);  // radius along north
  const double turn = std::remainder(position.scalar_of(1, row) - longitude, 2.0 * std::numbers::pi);
  return {(meridian + height) * (position.scalar_of(0, row) - latitude), (normal + height) * std::cos(latitude) * turn,
          height - position.raw(2, row)};
}

std::string GeodeticOrigin::note() const {
  char text[120];
  std::snprintf(text, sizeof text, "pose_capture: north and east are counted from the first fix, %.7f deg, %.7f deg",
                latitude / kDegree, longitude / kDegree);
  return text;
}

}  // namespace fathom::tables
