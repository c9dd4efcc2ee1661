#include "common/estimation/corrected_recording.hpp"

#include <algorithm>
#include <cmath>

#include "common/base/spatial.hpp"

namespace fathom::estimation {
namespace {

constexpr double kDoubt = 0.4;  // s around a moment at which the gyro contradicts the pose

template <class Stream>
void shift(Stream& stream, double seconds) {
  for (auto& one : stream) one.utime = utime_after(one.utime, seconds);
}

}  // namespace

Recording corrected(Recording recording, const Corrections& corrections) {
  Utime origin = 0;
  for (const Utime first : {recording.ahrs.empty() ? Utime{} : recording.ahrs.front().utime,
                            recording.pose_capture.empty() ? Utime{} : recording.pose_capture.front().utime}) {
    if (first != 0) origin = origin == 0 ? first : std::min(origin, first);
  }
  PoseSeries poses;
  for (const PoseCapture& pose : recording.pose_capture) {
    poses.t.push_back(seconds_between(origin, pose.utime));
    poses.p_WB.push_back(pose.p_WB);
    poses.q_WB.push_back(pose.q_WB);
    poses.valid.push_back(pose.valid ? 1 : 0);
  }
  correct_pose(corrections, poses);
  for (std::size_t i = 0; i < poses.size(); ++i) {
    PoseCapture& pose = recording.pose_capture[i];
    pose.p_WB = poses.p_WB[i];
    pose.q_WB = poses.q_WB[i];
    pose.valid = poses.valid[i] != 0;
    for (const double t : corrections.doubtful_pose) {
      if (std::abs(poses.t[i] - t) < kDoubt) pose.valid = false;
    }
  }
  if (std::ranges::none_of(recording.pose_capture, &PoseCapture::has_attitude)) {
    poses = {};
    for (const Ahrs& ahrs : recording.ahrs) {
      if (!ahrs.has_attitude) continue;
      poses.t.push_back(seconds_between(origin, ahrs.utime));
      poses.p_WB.emplace_back(Eigen::Vector3d::Zero());
      poses.q_WB.push_back(ahrs.q_WB);
      poses.valid.push_back(1);
    }
    correct_pose(corrections, poses);
  }
  for (double& t : poses.t) t += corrections.pose_shift;
  // On the common clock the attitude says where the body's axes point.
  const auto turned = [&](VectorFrame frame, const Eigen::Matrix3d& world, Utime utime, double by, Eigen::Vector3d& x) {
    Series alone{.t = {seconds_between(origin, utime) + by}, .x = {x}};
    to_body(frame, world, poses, alone);
    if (!alone.empty()) x = alone.x.front();
    return !alone.empty();
  };
  for (Ahrs& ahrs : recording.ahrs) {
    if (corrections.rates_frame != VectorFrame::kBody)
      ahrs.has_rates = ahrs.has_rates && turned(corrections.rates_frame, corrections.rates_world, ahrs.utime,
                                                corrections.gyro_shift, ahrs.w_WB_B);
  }
  for (Dvl& dvl : recording.dvl) {
    if (corrections.velocity_frame != VectorFrame::kBody)
      dvl.valid = turned(corrections.velocity_frame, corrections.velocity_world, dvl.utime, corrections.dvl_shift,
                         dvl.v_WB_B) &&
                  dvl.valid;
  }
  for (Ahrs& ahrs : recording.ahrs) {
    ahrs.w_WB_B = corrections.gyro.matrix() * ahrs.w_WB_B + corrections.gyro.bias;
    ahrs.f_B = corrections.accelerometer.matrix() * ahrs.f_B + corrections.accelerometer.bias;
  }
  shift(recording.pose_capture, corrections.pose_shift);
  shift(recording.ahrs, corrections.gyro_shift);
  shift(recording.dvl, corrections.dvl_shift);
  std::size_t k = 0;
  const SensorFault& fault = corrections.dvl;
  for (Dvl& dvl : recording.dvl) {
    while (k + 1 < recording.ahrs.size() && recording.ahrs[k + 1].utime <= dvl.utime) ++k;
    const Eigen::Vector3d w =
        recording.ahrs.empty() ? Eigen::Vector3d(Eigen::Vector3d::Zero()) : recording.ahrs[k].w_WB_B;
    dvl.v_WB_B = fault.matrix() * dvl.v_WB_B + fault.bias + (skew(fault.lever) + fault.coupling) * w;
  }
  return recording;
}

}  // namespace fathom::estimation
