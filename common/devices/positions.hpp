// Positions of acoustic systems to north, east, down of the world.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "common/devices/settings.hpp"

namespace fathom::devices {

/// From forward and starboard of the transceiver's heading [m] and depth below it [m].
[[nodiscard]] Eigen::Vector3d from_head_up(double forward, double starboard, double depth, const Transceiver& from);
/// From north and east of the transceiver [m].
[[nodiscard]] Eigen::Vector3d from_north_up(double north, double east, double depth, const Transceiver& from);
/// From latitude and longitude [rad]; flat earth about the world's origin, which must be stated.
[[nodiscard]] std::optional<Eigen::Vector3d> from_degrees(double latitude, double longitude, double depth,
                                                          const Transceiver& from);
/// From UTM northing and easting [m]; grid north is taken for north.
[[nodiscard]] std::optional<Eigen::Vector3d> from_grid(double northing, double easting, double depth,
                                                       const Transceiver& from);

/// Which transponder is the vehicle's. Others may be tracked besides; while it is never heard that is worth a word.
class WantedBeacon {
 public:
  /// Empty: every one.
  explicit WantedBeacon(std::string name) : name_{std::move(name)} {}
  [[nodiscard]] bool is(std::string_view heard);
  [[nodiscard]] const std::string& complaint() const { return complaint_; }

 private:
  std::string name_, stranger_, complaint_;
  bool met_{false};
};

}  // namespace fathom::devices
