// Attitudes by which what is along the world's axes is turned into the body's.
#pragma once

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "common/base/error.hpp"
#include "common/base/spatial.hpp"
#include "common/samples/recording.hpp"
#include "common/tables/column_map.hpp"

namespace fathom::tables {

/// Attitudes in the order of time, between which others lie.
class Attitudes {
 public:
  explicit Attitudes(const Recording& recording) {
    for (const PoseCapture& pose : recording.pose_capture) {
      if (pose.has_attitude && pose.valid) keep(pose.utime, pose.q_WB);
    }
    if (!q_.empty()) return;
    for (const Ahrs& ahrs : recording.ahrs) {
      if (ahrs.has_attitude) keep(ahrs.utime, ahrs.q_WB);
    }
  }
  void keep(Utime utime, const Eigen::Quaterniond& q) {
    t_.push_back(utime);
    q_.push_back(q);
  }
  [[nodiscard]] bool empty() const { return q_.empty(); }
  /// Nothing where the nearest ones are further apart than kLongest.
  [[nodiscard]] std::optional<Eigen::Quaterniond> at(Utime utime) const {
    const auto after = std::ranges::lower_bound(t_, utime);
    const auto i = static_cast<std::size_t>(after - t_.begin());
    if (after != t_.end() && *after == utime) return q_[i];
    if (after == t_.end() || i == 0) return std::nullopt;
    const double gap = seconds_between(t_[i - 1], t_[i]);
    if (gap > kLongest) return std::nullopt;
    return q_[i - 1].slerp(seconds_between(t_[i - 1], utime) / gap, q_[i]);
  }

 private:
  static constexpr double kLongest = 1.0;  // s: a craft that turns by 10 deg/s is then told within a degree or two
  std::vector<Utime> t_;
  std::vector<Eigen::Quaterniond> q_;
};

/// p q r of the rates of roll, pitch and yaw (Fossen 2011, eq. 2.28).
inline Eigen::Vector3d rates_from_euler(const Eigen::Vector3d& rates, const Eigen::Quaterniond& q_WB) {
  const Eigen::Vector3d euler = euler_from_rotation(q_WB.toRotationMatrix());
  const double roll = euler.x(), pitch = euler.y();
  return {rates.x() - std::sin(pitch) * rates.z(),
          std::cos(roll) * rates.y() + std::sin(roll) * std::cos(pitch) * rates.z(),
          -std::sin(roll) * rates.y() + std::cos(roll) * std::cos(pitch) * rates.z()};
}

[[noreturn]] inline void refuse_world_axes(const std::vector<Column>& columns, const std::string& what) {
  throw InputError(columns.front().where + ": the " + what +
                   " along the world's axes need an attitude to be turned into the body's; name its columns "
                   "(euler or quaternion under pose_capture or ahrs)");
}

}  // namespace fathom::tables
