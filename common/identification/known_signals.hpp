// What a log's SIGNAL tells of a trial's surroundings: the water's velocity, the length of umbilical paid out.
#pragma once

#include <Eigen/Core>
#include <array>
#include <string_view>
#include <vector>

#include "common/samples/recording.hpp"

namespace fathom::identification {

/// Quantities of SIGNAL (lcmtypes/signal_t.lcm): along W, m/s; m.
inline constexpr std::array<const char*, 3> kWaterVelocity{"water_velocity_north", "water_velocity_east",
                                                           "water_velocity_down"};
inline constexpr const char* kPaidOut = "tether_paid_out";

/// One quantity over time: straight lines between its values, held at the ends.
class KnownSignal {
 public:
  KnownSignal() = default;
  /// InputError when the values are told in another unit.
  KnownSignal(const Recording& recording, std::string_view quantity, std::string_view unit);
  [[nodiscard]] bool empty() const { return times_.empty(); }
  [[nodiscard]] double at(Utime utime) const;    ///< 0 when empty
  [[nodiscard]] double rate(Utime utime) const;  ///< 1/s, of the line; 0 outside
 private:
  [[nodiscard]] std::size_t above(Utime utime) const;
  std::vector<Utime> times_;
  std::vector<double> values_;
};

/// v_WF; a component that is not told is zero.
class KnownFlow {
 public:
  explicit KnownFlow(const Recording& recording);
  [[nodiscard]] bool empty() const;
  [[nodiscard]] Eigen::Vector3d velocity(Utime utime) const;      ///< m/s
  [[nodiscard]] Eigen::Vector3d acceleration(Utime utime) const;  ///< m/s^2
 private:
  std::array<KnownSignal, 3> components_;
};

}  // namespace fathom::identification
