#include "common/devices/positions.hpp"

#include <cmath>

#include "common/base/spatial.hpp"

namespace fathom::devices {

Eigen::Vector3d from_north_up(double north, double east, double depth, const Transceiver& from) {
  return from.p_W + Eigen::Vector3d{north, east, depth};
}

Eigen::Vector3d from_head_up(double forward, double starboard, double depth, const Transceiver& from) {
  return from.p_W + rotation_from_euler({0.0, 0.0, from.heading}) * Eigen::Vector3d{forward, starboard, depth};
}

std::optional<Eigen::Vector3d> from_degrees(double latitude, double longitude, double depth, const Transceiver& from) {
  if (!from.latitude || !from.longitude) return {};
  constexpr double kRadius = 6378137.0;                // m, WGS84
  constexpr double kEccentricity2 = 6.69437999014e-3;  // squared
  const double s = std::sin(*from.latitude);
  const double w = 1.0 - kEccentricity2 * s * s;
  const double meridian = kRadius * (1.0 - kEccentricity2) / (w * std::sqrt(w));
  const double normal = kRadius / std::sqrt(w);
  return Eigen::Vector3d{(latitude - *from.latitude) * meridian,
                         wrap_angle(longitude - *from.longitude) * normal * std::cos(*from.latitude),
                         depth + from.p_W.z()};
}

std::optional<Eigen::Vector3d> from_grid(double northing, double easting, double depth, const Transceiver& from) {
  if (!from.northing || !from.easting) return {};
  return Eigen::Vector3d{northing - *from.northing, easting - *from.easting, depth + from.p_W.z()};
}

bool WantedBeacon::is(std::string_view heard) {
  const bool ours = name_.empty() || heard == name_;
  if (ours) {
    met_ = true;
    complaint_.clear();
  } else if (!met_ && stranger_ != heard) {
    stranger_ = heard;
    complaint_ = "positions of transponder " + stranger_ + " come, none of " + name_ + "; is 'beacon' right?";
  }
  return ours;
}

}  // namespace fathom::devices
