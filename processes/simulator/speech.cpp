#include "processes/simulator/speech.hpp"

#include <fathom_lcm/ahrs_t.hpp>
#include <fathom_lcm/battery_t.hpp>
#include <fathom_lcm/camera_t.hpp>
#include <fathom_lcm/depth_t.hpp>
#include <fathom_lcm/dvl_t.hpp>
#include <fathom_lcm/laser_range_t.hpp>
#include <fathom_lcm/loads_t.hpp>
#include <fathom_lcm/optical_flow_t.hpp>
#include <fathom_lcm/pose_capture_t.hpp>
#include <fathom_lcm/ranges_t.hpp>
#include <fathom_lcm/signal_t.hpp>
#include <fathom_lcm/tag_pose_t.hpp>
#include <fathom_lcm/thrusters_t.hpp>
#include <fathom_lcm/truth_t.hpp>
#include <fathom_lcm/usbl_t.hpp>

#include "common/wire/channels.hpp"
#include "common/wire/minds.hpp"
#include "common/wire/sensors.hpp"

namespace fathom::simulator {
namespace {

const char* channel_of(const Thrusters&) { return wire::kThrusters; }
const char* channel_of(const Battery&) { return wire::kBattery; }
const char* channel_of(const Loads&) { return wire::kLoads; }
const char* channel_of(const Ahrs&) { return wire::kAhrs; }
const char* channel_of(const Dvl&) { return wire::kDvl; }
const char* channel_of(const Depth&) { return wire::kDepth; }
const char* channel_of(const Usbl&) { return wire::kUsbl; }
const char* channel_of(const Ranges&) { return wire::kRanges; }
const char* channel_of(const PoseCapture&) { return wire::kPoseCapture; }
const char* channel_of(const TagPose&) { return wire::kTagPose; }
const char* channel_of(const OpticalFlow&) { return wire::kOpticalFlow; }
const char* channel_of(const LaserRange&) { return wire::kLaserRange; }
const char* channel_of(const Signal&) { return wire::kSignal; }
const char* channel_of(const simulation::Exposure&) { return wire::kCamera; }
const char* channel_of(const Truth&) { return wire::kTruth; }

}  // namespace

void declare_speech(runtime::Process& process) {
  process.publishes<fathom_lcm::thrusters_t>(wire::kThrusters);
  process.publishes<fathom_lcm::battery_t>(wire::kBattery);
  process.publishes<fathom_lcm::loads_t>(wire::kLoads);
  process.publishes<fathom_lcm::ahrs_t>(wire::kAhrs);
  process.publishes<fathom_lcm::dvl_t>(wire::kDvl);
  process.publishes<fathom_lcm::depth_t>(wire::kDepth);
  process.publishes<fathom_lcm::usbl_t>(wire::kUsbl);
  process.publishes<fathom_lcm::ranges_t>(wire::kRanges);
  process.publishes<fathom_lcm::pose_capture_t>(wire::kPoseCapture);
  process.publishes<fathom_lcm::tag_pose_t>(wire::kTagPose);
  process.publishes<fathom_lcm::optical_flow_t>(wire::kOpticalFlow);
  process.publishes<fathom_lcm::laser_range_t>(wire::kLaserRange);
  process.publishes<fathom_lcm::signal_t>(wire::kSignal);
  process.publishes<fathom_lcm::camera_t>(wire::kCamera);
  process.publishes<fathom_lcm::truth_t>(wire::kTruth);
}

void speak(runtime::Process& process, Darkroom& darkroom, const simulation::Sample& sample) {
  std::visit(
      [&](const auto& one) {
        if constexpr (std::is_same_v<std::decay_t<decltype(one)>, simulation::Exposure>) {
          if (darkroom.has_line()) {
            darkroom.send(one);
          } else {
            process.publish(channel_of(one), wire::encode(darkroom.develop(one)));
          }
        } else {
          process.publish(channel_of(one), wire::encode(one));
        }
      },
      sample);
}

}  // namespace fathom::simulator
