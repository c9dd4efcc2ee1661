#include "common/consistency/flow_check.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "common/base/spatial.hpp"
#include "common/estimation/online/camera_geometry.hpp"

namespace fathom::consistency {

using estimation::CameraMount;
using estimation::distance_to_floor;
using estimation::velocity_from_flow;
using estimation::velocity_of_camera;

namespace {

constexpr double kNear = 0.1;      // s between a picture and the state that supplies its attitude
constexpr double kOwnArm = 0.03;   // m: less changes no fitted model by much
constexpr double kTurned = 0.035;  // rad: rates that are turned by that much leave an arm of that share of the height

/// The motion nearest to a time stamp, nullptr when there is none near or it does not count.
const MotionAt* near(const std::deque<MotionAt>& motion, Utime utime) {
  auto at = std::ranges::lower_bound(motion, utime, {}, &MotionAt::utime);
  if (at != motion.begin() && (at == motion.end() || at->utime - utime > utime - std::prev(at)->utime)) --at;
  if (at == motion.end() || !at->valid || std::abs(seconds_between(utime, at->utime)) > kNear) return nullptr;
  return &*at;
}

Recording flow_and_tags(const Recording& recording, const model::Mounts& mounts, const model::Site& site) {
  Recording seen{.name = recording.name};
  if (recording.state.empty()) return seen;
  FlowWitnesses witnesses{mounts, site};
  for (const TagPose& tag : recording.tag_pose) witnesses.hear(tag);
  for (const OpticalFlow& flow : recording.optical_flow) witnesses.hear(flow);
  std::deque<MotionAt> motion;
  for (const StateEstimate& state : recording.state) motion.push_back(motion_of(state));
  seen = witnesses.seen(motion, motion.front().utime, motion.back().utime);
  seen.name = recording.name;
  return seen;
}

/// m, of an arm that is the flow's own and not a turned gyro's, whose rates vision took the turning out with.
double least_arm(std::span<const Recording> seen, const model::Site& site) {
  double height = 0.0, count = 0.0;
  for (const Recording& one : seen) {
    for (const PoseCapture& pose : one.pose_capture) height += site.floor - pose.p_WB.z();
    count += static_cast<double>(one.pose_capture.size());
  }
  return std::max(kOwnArm, count > 0.0 ? kTurned * height / count : 0.0);
}

/// What the filter made of the flow is late and smooth where the motion is quick, which looks like a lag of the thrust:
/// the flow's own velocity takes the place of STATE's.
void take_flow_as_measured(std::span<Recording> recordings, std::span<const Recording> seen) {
  for (std::size_t r = 0; r < recordings.size(); ++r) {
    if (recordings[r].one_estimate && !seen[r].dvl.empty()) recordings[r].dvl = seen[r].dvl;
  }
}

void correct_what_rests_on_flow(std::span<Recording> recordings, std::vector<Recording>& seen, const model::Site& site,
                                std::vector<Corrections>& corrections) {
  for (std::size_t r = 0; r < recordings.size(); ++r) {
    if (!recordings[r].one_estimate || seen[r].dvl.empty()) continue;
    const ConsistencyResult checked = check_consistency(std::span(&seen[r], 1));
    const SensorFault& fault = checked.corrections.front().dvl;
    corrections[r].dvl.scale.head<2>() = fault.scale.head<2>();
    corrections[r].dvl_shift -= fault.delay;
    if (fault.lever.cwiseAbs().maxCoeff() > least_arm(seen, site)) {  // u and v alone: heave is not the flow's
      corrections[r].dvl.coupling.topRows<2>() = skew(fault.lever).topRows<2>();
    }
    recordings[r].pose_capture = std::move(seen[r].pose_capture);  // STATE's is led astray by the flow
  }
}

/// Of what the velocity comparison can find, only this is the flow's own: across the optical axis it is one angle times
/// one distance, and a camera that is mounted otherwise than told moves tags and flow alike. So an arm that the tags do
/// not share is no place of the camera, but turning that was taken out of the flow wrongly.
bool is_the_flows(const ConsistencyFinding& finding, double least_arm) {
  if (finding.finding == "delay") return finding.signal == "dvl";
  if (finding.finding.starts_with("lever_arm_")) return std::abs(finding.size) > least_arm;
  const bool kind = finding.finding == "scale" || finding.finding == "sign" || finding.finding == "axes";
  return kind && (finding.signal == "dvl.u" || finding.signal == "dvl.v");
}

}  // namespace

MotionAt motion_of(const StateEstimate& state) {
  return {.utime = state.utime, .p_WB = state.p_WB, .q_WB = state.q_WB, .nu = state.nu, .valid = state.valid};
}

FlowWitnesses::FlowWitnesses(const model::Mounts& mounts, const model::Site& site)
    : cameras_{mounts.cameras}, site_{site} {}

std::size_t FlowWitnesses::camera(const std::string& name) const {
  return static_cast<std::size_t>(std::ranges::find(cameras_, name, &model::CameraMount::name) - cameras_.begin());
}

void FlowWitnesses::hear(const TagPose& tag) {
  const std::size_t c = camera(tag.camera);
  const model::Tag* mapped = site_.tag(tag.tag);
  if (c == cameras_.size() || mapped == nullptr || !tag.p_CT.allFinite()) return;
  // What is said again bit by bit was not measured again: a camera that is frozen is no witness.
  Eigen::Vector3d& last = last_.try_emplace({c, tag.tag}, Eigen::Vector3d::Constant(NAN)).first->second;
  if (last == tag.p_CT) return;
  last = tag.p_CT;
  if (pictures_.empty() || pictures_.back().utime != tag.utime) {
    pictures_.push_back({tag.utime, Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero()});
  }
  const model::Mount& mount = cameras_[c].mount;
  pictures_.back().sum_p_WT += mapped->p_WT;
  pictures_.back().sum_p_BT += mount.p_BS + mount.R_BS * tag.p_CT;
  pictures_.back().tags += 1.0;
}

void FlowWitnesses::hear(const OpticalFlow& flow) {
  const std::size_t c = camera(flow.camera);
  if (c == cameras_.size() || !flow.flow_C.allFinite()) return;
  flows_.push_back({flow.utime, c, flow.flow_C});
}

void FlowWitnesses::forget_before(Utime utime) {
  while (!pictures_.empty() && pictures_.front().utime < utime) pictures_.pop_front();
  while (!flows_.empty() && flows_.front().utime < utime) flows_.pop_front();
}

void FlowWitnesses::clear() {
  pictures_.clear();
  flows_.clear();
  last_.clear();
}

Recording FlowWitnesses::seen(const std::deque<MotionAt>& motion, Utime begin, Utime end) const {
  Recording seen;
  const auto within = [&](Utime utime) { return utime >= begin && utime <= end; };
  for (const Picture& picture : pictures_) {
    const MotionAt* at = within(picture.utime) ? near(motion, picture.utime) : nullptr;
    if (at == nullptr) continue;
    const Eigen::Vector3d p_WB = (picture.sum_p_WT - at->q_WB * picture.sum_p_BT) / picture.tags;  // (1.24), the mean
    seen.pose_capture.push_back({.utime = picture.utime, .p_WB = p_WB, .q_WB = at->q_WB, .valid = true});
  }
  for (const Flow& flow : flows_) {
    const MotionAt* at = within(flow.utime) ? near(motion, flow.utime) : nullptr;
    if (at == nullptr) continue;
    const model::Mount& mount = cameras_[flow.camera].mount;
    const CameraMount camera{.p_BC = mount.p_BS, .R_BC = mount.R_BS};
    const double distance = distance_to_floor(site_.floor, at->p_WB, camera, at->q_WB.toRotationMatrix());
    if (!(distance > 0.0)) continue;
    const Eigen::Vector3d w_B = at->nu.tail<3>();
    Eigen::Vector3d v_C = velocity_of_camera(at->nu.head<3>(), w_B, camera);
    v_C.head<2>() = velocity_from_flow(flow.flow_C, distance).head<2>();
    seen.dvl.push_back({.utime = flow.utime, .v_WB_B = camera.R_BC * v_C - w_B.cross(camera.p_BC)});
  }
  return seen;
}

PairResult compare_flow(std::span<const Recording> seen, const model::Site& site) {
  ConsistencyResult checked = check_consistency(seen);
  PairResult flow = std::move(checked.pairs.at("dvl"));
  const double least = least_arm(seen, site);
  std::erase_if(flow.findings, [&](const ConsistencyFinding& one) { return !is_the_flows(one, least); });
  const auto rename = [](auto& one) {  // compared as if they were a velocity log and a motion capture
    one.signal.replace(0, 3, "optical_flow");
    one.reference = "tag_pose";
  };
  std::ranges::for_each(flow.findings, rename);
  std::ranges::for_each(flow.statements, rename);
  return flow;
}

void check_flow(std::span<Recording> recordings, const model::Mounts& mounts, const model::Site& site,
                ConsistencyResult& result) {
  std::vector<Recording> seen;
  for (const Recording& one : recordings) seen.push_back(flow_and_tags(one, mounts, site));
  if (std::ranges::all_of(seen, [](const Recording& one) { return one.dvl.empty(); })) return;
  take_flow_as_measured(recordings, seen);
  PairResult flow = compare_flow(seen, site);
  if (!flow.findings.empty()) correct_what_rests_on_flow(recordings, seen, site, result.corrections);
  std::ranges::move(flow.findings, std::back_inserter(result.findings));
  result.pairs.emplace("optical_flow", std::move(flow));
}

}  // namespace fathom::consistency
