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
  PoseSeries one{.t = {0.0}, .p_WB = {Eigen::Vector3d::Zero()}, .q_WB = {Eigen::Quaterniond::Identity()}, .valid = {1}};
  for (PoseCapture& pose : recording.pose_capture) {
    for (const double t : corrections.doubtful_pose) {
      if (std::abs(seconds_between(origin, pose.utime) - t) < kDoubt) pose.valid = false;
    }
    one.p_WB.front() = pose.p_WB;
    one.q_WB.front() = pose.q_WB;
    correct_pose(corrections, one);
    pose.p_WB = one.p_WB.front();
    pose.q_WB = one.q_WB.front();
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
