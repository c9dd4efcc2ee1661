// Is the MAVLink vehicle that answers the one that is to be driven, and does it obey?
#pragma once

#include <optional>
#include <string>

namespace fathom::devices {
class Mavlink;
}

namespace fathom::driver {

/// Pure: times are passed in, in seconds of any steady clock.
class VehicleCheck {
 public:
  /// `system`: MAVLink number that commands are meant for.
  explicit VehicleCheck(int system) : system_{system} {}
  /// The latest packet of the parser.
  void hear(const devices::Mavlink& packet, double now);
  /// One line with the remedy; empty while nothing speaks against it.
  [[nodiscard]] std::string objection(double now) const;

 private:
  int system_;
  std::optional<double> right_at_, wrong_at_, refused_at_, warned_at_;  ///< heartbeats, refusals, its own words
  std::string wrong_, warning_;
  int result_{};
};

}  // namespace fathom::driver
