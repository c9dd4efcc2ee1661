#include "common/estimation/smoothing/aids_seen.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <string>

#include "common/estimation/online/camera_geometry.hpp"

namespace fathom::estimation {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kNear = 0.1;  // s between an aid's sample and the state that supplies its attitude

/// The state nearest to a time stamp.
class States {
 public:
  explicit States(const std::vector<StateEstimate>& states) : states_{states} {}
  [[nodiscard]] const StateEstimate* near(Utime utime) const {
    auto at = std::lower_bound(states_.begin(), states_.end(), utime,
                               [](const StateEstimate& s, Utime t) { return s.utime < t; });
    if (at != states_.begin() && (at == states_.end() || at->utime - utime > utime - std::prev(at)->utime)) --at;
    if (at == states_.end() || std::abs(seconds_between(utime, at->utime)) > kNear) return nullptr;
    return &*at;
  }

 private:
  const std::vector<StateEstimate>& states_;
};

std::optional<CameraMount> camera_of(const model::Mounts& mounts, const std::string& name) {
  const model::CameraMount* found = mounts.camera(name);
  if (found == nullptr) return {};
  return CameraMount{.p_BC = found->mount.p_BS, .R_BC = found->mount.R_BS};
}

void add(Seen& seen, double t, const Eigen::Vector3d& x) {
  seen.t.push_back(t);
  seen.x.push_back(x);
}

Seen seen_tags(const Recording& recording, const States& states, const model::Mounts& mounts, const model::Site& site,
               Utime origin) {
  Seen seen;
  const std::vector<TagPose>& all = recording.tag_pose;
  for (std::size_t first = 0, end = 0; first < all.size(); first = end) {
    while (end < all.size() && all[end].utime == all[first].utime) ++end;
    const StateEstimate* state = states.near(all[first].utime);
    if (state == nullptr) continue;
    const Eigen::Matrix3d R_WB = state->q_WB.toRotationMatrix();
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    double count = 0.0;
    for (std::size_t i = first; i < end; ++i) {
      const auto mount = camera_of(mounts, all[i].camera);
      const model::Tag* tag = site.tag(all[i].tag);
      if (!mount || tag == nullptr) continue;
      sum += position_from_tag(tag->p_WT, all[i].p_CT, *mount, R_WB);
      count += 1.0;
    }
    if (count > 0.0) add(seen, seconds_between(origin, all[first].utime), sum / count);
  }
  return seen;
}

Seen seen_flow(const Recording& recording, const States& states, const model::Mounts& mounts, const model::Site& site,
               Utime origin) {
  Seen seen;
  for (const OpticalFlow& one : recording.optical_flow) {
    const StateEstimate* state = states.near(one.utime);
    const auto mount = camera_of(mounts, one.camera);
    if (state == nullptr || !mount) continue;
    const Eigen::Matrix3d R_WB = state->q_WB.toRotationMatrix();
    const double distance = distance_to_floor(site.floor, state->p_WB, *mount, R_WB);
    if (!(distance > 0.0)) continue;
    const Eigen::Vector3d w_B = state->nu.tail<3>();
    Eigen::Vector3d v_C = velocity_of_camera(state->nu.head<3>(), w_B, *mount);
    const Eigen::Vector3d by_flow = velocity_from_flow(one.flow_C, distance);
    v_C.head<2>() = by_flow.head<2>();
    if (one.tells_approach()) v_C.z() = by_flow.z();
    const Eigen::Vector3d v_B = mount->R_BC * v_C - w_B.cross(mount->p_BC);
    add(seen, seconds_between(origin, one.utime), {v_B.x(), v_B.y(), one.tells_approach() ? v_B.z() : kNaN});
  }
  return seen;
}

Seen seen_laser(const Recording& recording, const States& states, const model::Mounts& mounts, const model::Site& site,
                Utime origin) {
  Seen seen;
  for (const LaserRange& one : recording.laser_range) {
    const StateEstimate* state = states.near(one.utime);
    const auto mount = camera_of(mounts, one.camera);
    if (state == nullptr || !mount) continue;
    const double z = depth_from_floor_point(site.floor, one.p_CL, *mount, state->q_WB.toRotationMatrix());
    add(seen, seconds_between(origin, one.utime), {kNaN, kNaN, z});
  }
  return seen;
}

}  // namespace

AidsSeen aids_seen(const Recording& recording, const model::Mounts& mounts, const model::Site& site, Utime origin) {
  const States states{recording.state};
  AidsSeen seen;
  seen.tags = seen_tags(recording, states, mounts, site, origin);
  seen.flow = seen_flow(recording, states, mounts, site, origin);
  seen.laser = seen_laser(recording, states, mounts, site, origin);
  for (const Usbl& one : recording.usbl) {
    if (one.valid) add(seen.usbl, seconds_between(origin, one.utime), one.p_WB);
  }
  for (const Dvl& one : recording.dvl) {
    if (one.valid && !one.held) add(seen.dvl, seconds_between(origin, one.utime), one.v_WB_B);
  }
  for (const Depth& one : recording.depth) {
    add(seen.depth, seconds_between(origin, one.utime), {kNaN, kNaN, one.z});
  }
  return seen;
}

}  // namespace fathom::estimation
