// Messages of instruments and of vision to samples, and back. Include the message's own header to use a pair.
#pragma once

#include <optional>

#include "common/samples/sensors.hpp"
#include "common/samples/vision.hpp"

namespace fathom_lcm {
class ahrs_t;
class camera_t;
class dvl_t;
class usbl_t;
class depth_t;
class ranges_t;
class loads_t;
class pose_capture_t;
class battery_t;
class signal_t;
class thrusters_t;
class tag_pose_t;
class optical_flow_t;
class laser_range_t;
}  // namespace fathom_lcm

namespace fathom::wire {

/// Nothing when a length is wrong, a number is not finite, or a quaternion is not unit.
[[nodiscard]] std::optional<Ahrs> decode(const fathom_lcm::ahrs_t& message);
[[nodiscard]] std::optional<Camera> decode(const fathom_lcm::camera_t& message);
[[nodiscard]] std::optional<Dvl> decode(const fathom_lcm::dvl_t& message);
[[nodiscard]] std::optional<Usbl> decode(const fathom_lcm::usbl_t& message);
[[nodiscard]] std::optional<Depth> decode(const fathom_lcm::depth_t& message);
[[nodiscard]] std::optional<Ranges> decode(const fathom_lcm::ranges_t& message);
[[nodiscard]] std::optional<Loads> decode(const fathom_lcm::loads_t& message);
[[nodiscard]] std::optional<Signal> decode(const fathom_lcm::signal_t& message);
[[nodiscard]] std::optional<PoseCapture> decode(const fathom_lcm::pose_capture_t& message);
[[nodiscard]] std::optional<Battery> decode(const fathom_lcm::battery_t& message);
[[nodiscard]] std::optional<Thrusters> decode(const fathom_lcm::thrusters_t& message);
[[nodiscard]] std::optional<TagPose> decode(const fathom_lcm::tag_pose_t& message);
[[nodiscard]] std::optional<OpticalFlow> decode(const fathom_lcm::optical_flow_t& message);
[[nodiscard]] std::optional<LaserRange> decode(const fathom_lcm::laser_range_t& message);

[[nodiscard]] fathom_lcm::ahrs_t encode(const Ahrs& sample);
[[nodiscard]] fathom_lcm::camera_t encode(const Camera& sample);
[[nodiscard]] fathom_lcm::dvl_t encode(const Dvl& sample);
[[nodiscard]] fathom_lcm::usbl_t encode(const Usbl& sample);
[[nodiscard]] fathom_lcm::depth_t encode(const Depth& sample);
[[nodiscard]] fathom_lcm::ranges_t encode(const Ranges& sample);
[[nodiscard]] fathom_lcm::loads_t encode(const Loads& sample);
[[nodiscard]] fathom_lcm::signal_t encode(const Signal& sample);
[[nodiscard]] fathom_lcm::pose_capture_t encode(const PoseCapture& sample);
[[nodiscard]] fathom_lcm::battery_t encode(const Battery& sample);
[[nodiscard]] fathom_lcm::thrusters_t encode(const Thrusters& sample);
[[nodiscard]] fathom_lcm::tag_pose_t encode(const TagPose& sample);
[[nodiscard]] fathom_lcm::optical_flow_t encode(const OpticalFlow& sample);
[[nodiscard]] fathom_lcm::laser_range_t encode(const LaserRange& sample);

}  // namespace fathom::wire
