#include <fathom_lcm/camera_t.hpp>
#include <fathom_lcm/laser_range_t.hpp>
#include <fathom_lcm/optical_flow_t.hpp>
#include <fathom_lcm/tag_pose_t.hpp>

#include "common/wire/plausible.hpp"
#include "common/wire/sensors.hpp"

namespace fathom::wire {

std::optional<Camera> decode(const fathom_lcm::camera_t& message) {
  if (!length(message.n_jpeg, message.jpeg.size()) || message.width <= 0 || message.height <= 0) return {};
  return Camera{.utime = message.utime,
                .camera = message.camera,
                .width = message.width,
                .height = message.height,
                .jpeg = message.jpeg};
}

fathom_lcm::camera_t encode(const Camera& sample) {
  fathom_lcm::camera_t message{};
  message.utime = sample.utime;
  message.camera = sample.camera;
  message.width = sample.width;
  message.height = sample.height;
  message.n_jpeg = count(sample.jpeg);
  message.jpeg = sample.jpeg;
  return message;
}

std::optional<TagPose> decode(const fathom_lcm::tag_pose_t& message) {
  if (!finite(message.p_CT) || !unit(message.q_CT) || !finite(message.reprojection_error)) return {};
  return TagPose{.utime = message.utime,
                 .camera = message.camera,
                 .tag = message.tag,
                 .p_CT = vector(message.p_CT),
                 .q_CT = quaternion(message.q_CT),
                 .reprojection_error = message.reprojection_error};
}

fathom_lcm::tag_pose_t encode(const TagPose& sample) {
  fathom_lcm::tag_pose_t message{};
  message.utime = sample.utime;
  message.camera = sample.camera;
  message.tag = sample.tag;
  put(sample.p_CT, message.p_CT);
  put(sample.q_CT, message.q_CT);
  message.reprojection_error = sample.reprojection_error;
  return message;
}

std::optional<OpticalFlow> decode(const fathom_lcm::optical_flow_t& message) {
  if (!finite(message.flow_C) || !finite(message.interval) || !finite(message.covariance)) return {};
  if (message.covariance[0] < 0.0 || message.covariance[4] < 0.0) return {};  // the third alone may be unmeasured
  return OpticalFlow{
      .utime = message.utime,
      .camera = message.camera,
      .interval = message.interval,
      .flow_C = vector(message.flow_C),
      .covariance = Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(&message.covariance[0]),
      .n_tracks = message.n_tracks};
}

fathom_lcm::optical_flow_t encode(const OpticalFlow& sample) {
  fathom_lcm::optical_flow_t message{};
  message.utime = sample.utime;
  message.camera = sample.camera;
  message.interval = sample.interval;
  put(sample.flow_C, message.flow_C);
  Eigen::Map<Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>{&message.covariance[0]} = sample.covariance;
  message.n_tracks = sample.n_tracks;
  return message;
}

std::optional<LaserRange> decode(const fathom_lcm::laser_range_t& message) {
  if (!finite(message.p_CL) || !finite(message.sigma_range)) return {};
  return LaserRange{.utime = message.utime,
                    .camera = message.camera,
                    .p_CL = vector(message.p_CL),
                    .sigma_range = message.sigma_range};
}

fathom_lcm::laser_range_t encode(const LaserRange& sample) {
  fathom_lcm::laser_range_t message{};
  message.utime = sample.utime;
  message.camera = sample.camera;
  put(sample.p_CL, message.p_CL);
  message.sigma_range = sample.sigma_range;
  return message;
}

}  // namespace fathom::wire
