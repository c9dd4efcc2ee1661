#include "common/consistency/dead_axes.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "common/base/spatial.hpp"
#include "common/estimation/wording.hpp"

namespace fathom::consistency {

using estimation::text;

namespace {

constexpr double kSecond = 1.0;         // s between poses that are compared
constexpr std::size_t kFewest = 50;     // samples of a stream: fewer may well say the same
constexpr double kGrows = 1.5;          // motion over two seconds to that over one: noise of the pose does not grow
constexpr double kTurningShown = 0.03;  // rad/s (RMS): slower than that, a coarse gyro may say nothing
constexpr double kMovingShown = 0.02;   // m/s
constexpr double kLongestPause = 0.25;  // of the time between the poses, that a pause may add

struct Pose {
  double t{};  // s
  Eigen::Vector3d p_WB{Eigen::Vector3d::Zero()};
  Eigen::Quaterniond q_WB{Eigen::Quaterniond::Identity()};
};

std::vector<Pose> poses_of(const Recording& recording, bool with_position) {
  std::vector<Pose> poses;
  const auto add = [&](Utime utime, const Eigen::Vector3d& p_WB, const Eigen::Quaterniond& q_WB) {
    const double t = 1e-6 * static_cast<double>(utime - recording.pose_capture.front().utime);
    if (poses.empty() || t > poses.back().t) poses.push_back({t, p_WB, q_WB.normalized()});
  };
  for (const PoseCapture& pose : recording.pose_capture) {
    if (pose.valid && pose.has_attitude && (!with_position || pose.has_position) && pose.q_WB.norm() > 0.5)
      add(pose.utime, pose.p_WB, pose.q_WB);
  }
  return poses;
}

/// What moved from one pose to a later one, in body axes: m along them, then rad about them.
Vector6d moved(const Pose& from, const Pose& to) {
  Vector6d change;
  change.head<3>() = from.q_WB.conjugate() * (to.p_WB - from.p_WB);
  const Eigen::AngleAxisd turn(from.q_WB.conjugate() * to.q_WB);
  const double angle = std::remainder(turn.angle(), 2.0 * std::numbers::pi);
  change.tail<3>() = angle * turn.axis();
  return change;
}

/// RMS of what moves along each axis in `span` s; nothing where no two poses are so far apart.
std::optional<Vector6d> motion_in(std::span<const Pose> poses, double span) {
  Vector6d sum = Vector6d::Zero();
  double count = 0.0;
  for (std::size_t i = 0, k = 0; i < poses.size(); ++i) {
    while (k < poses.size() && poses[k].t < poses[i].t + span) ++k;
    if (k == poses.size()) break;
    if (poses[k].t > poses[i].t + (1.0 + kLongestPause) * span) continue;
    sum += moved(poses[i], poses[k]).cwiseAbs2();
    count += 1.0;
  }
  if (count < static_cast<double>(kFewest)) return {};
  return Vector6d{(sum / count).cwiseSqrt()};
}

/// m/s, rad/s (RMS) along each axis by the poses; zero where what they show may be their noise.
Vector6d speeds_by(std::span<const Pose> poses) {
  const auto one = motion_in(poses, kSecond), two = motion_in(poses, 2.0 * kSecond);
  if (!one || !two) return Vector6d::Zero();
  return (two->array() > kGrows * one->array()).select(0.5 / kSecond * *two, 0.0);
}

struct Axis {
  bool constant{true};
  double value{};
  std::size_t count{};

  void add(double x) {
    if (count++ == 0) value = x;
    constant = constant && x == value;
  }
  [[nodiscard]] bool dead() const { return constant && count >= kFewest; }
};

}  // namespace

std::vector<ConsistencyFinding> set_aside_dead_axes(std::span<Recording> recordings, const std::array<bool, 6>& dof) {
  constexpr std::array kNames{"dvl.u", "dvl.v", "dvl.w", "gyro.p", "gyro.q", "gyro.r"};
  std::vector<ConsistencyFinding> findings;
  for (Recording& recording : recordings) {
    std::array<Axis, 6> axes;
    for (const Dvl& dvl : recording.dvl) {
      for (std::size_t i = 0; dvl.valid && i < 3; ++i) axes[i].add(dvl.v_WB_B[static_cast<Eigen::Index>(i)]);
    }
    for (const Ahrs& ahrs : recording.ahrs) {
      for (std::size_t i = 0; ahrs.has_rates && i < 3; ++i) axes[3 + i].add(ahrs.w_WB_B[static_cast<Eigen::Index>(i)]);
    }
    const Vector6d speed = [&] {
      Vector6d both = speeds_by(poses_of(recording, true));
      both.tail<3>() = speeds_by(poses_of(recording, false)).tail<3>();
      return both;
    }();
    std::array<bool, 2> dead{};  // velocities, rates
    for (std::size_t i = 0; i < 6; ++i) {
      const double shown = speed[static_cast<Eigen::Index>(i)];
      if (!dof[i] || !axes[i].dead() || shown < (i < 3 ? kMovingShown : kTurningShown)) continue;
      dead[i / 3] = true;
      findings.push_back({.run = recording.name,
                          .signal = kNames[i],
                          .reference = "pose_capture",
                          .finding = "dead",
                          .size = shown,
                          .unit = i < 3 ? "m/s" : "rad/s",
                          .evidence = text("says %.3g throughout, while the pose shows %.2g ", axes[i].value, shown) +
                                      (i < 3 ? "m/s along it (RMS)" : "rad/s about it (RMS)"),
                          .action = i < 3 ? "no velocity of this recording used: the pose tells them"
                                          : "no rate of this recording used: the attitude tells them"});
    }
    if (dead[0]) recording.dvl.clear();
    for (Ahrs& ahrs : recording.ahrs) ahrs.has_rates = ahrs.has_rates && !dead[1];
  }
  return findings;
}

}  // namespace fathom::consistency
