// vision: pictures and attitude in; poses of tags, optical flow and the laser's range out.
#include <fathom_lcm/ahrs_t.hpp>
#include <fathom_lcm/camera_t.hpp>
#include <fathom_lcm/laser_range_t.hpp>
#include <fathom_lcm/optical_flow_t.hpp>
#include <fathom_lcm/tag_pose_t.hpp>

#include "common/base/config.hpp"
#include "common/base/error.hpp"
#include "common/model/mounts.hpp"
#include "common/model/site.hpp"
#include "common/runtime/command_line.hpp"
#include "common/runtime/process.hpp"
#include "common/vision/threads.hpp"
#include "common/vision/watch.hpp"
#include "common/wire/channels.hpp"
#include "common/wire/decode.hpp"
#include "common/wire/sensors.hpp"

using namespace fathom;

namespace {

constexpr int kDebugQuality = 80;

/// The one camera that the section names.
struct Rig {
  model::CameraMount camera;
  std::optional<model::LaserMount> laser;
};

Rig rig(const std::string& vehicle, const Config& config) {
  const model::Mounts mounts = model::Mounts::from(Config::load(vehicle).section("sensors"));
  const std::string wanted = config.text("camera");
  const model::CameraMount* camera = mounts.camera(wanted);
  if (camera == nullptr) config.fail("camera", "the vehicle file has no camera '" + wanted + "'");
  Rig found{.camera = *camera};
  if (mounts.laser && mounts.laser->camera == wanted) found.laser = mounts.laser;
  return found;
}

}  // namespace

int main(int argc, char** argv) {
  bool debug = false;
  double debug_every = 0.2;  // s between two drawn pictures
  const runtime::Program program{"vision", "Measures tags, optical flow and laser range in pictures."};
  return runtime::main(
      program, argc, argv,
      [&](runtime::Process& process) {
        vision::use_one_core();
        process.publishes<fathom_lcm::tag_pose_t>(wire::kTagPose);
        process.publishes<fathom_lcm::optical_flow_t>(wire::kOpticalFlow);
        process.publishes<fathom_lcm::laser_range_t>(wire::kLaserRange);
        process.publishes<fathom_lcm::camera_t>(wire::kCameraDebug);
        const Config config = process.config();
        const Rig used = rig(process.config_path("dof"), config);
        const std::string& name = used.camera.name;
        vision::Watch watch{model::Site::load_for_pictures(process.config_path("site")), used.camera, used.laser,
                            vision::FrontEndSettings::from(config)};
        Utime drawn = 0;
        std::string said;
        const auto tell = [&] {
          if (watch.complaint() == said) return;
          said = watch.complaint();
          if (said.empty()) {
            process.log_info("well: pictures can be read");
          } else {
            process.log_warning(said);
          }
          process.tell_health();
        };
        if (watch.front_end().lens() && watch.front_end().lens()->undistorted()) {
          process.log_info("the lens of camera '" + name +
                           "' has no distortion; if nobody has calibrated it: fathom calibrate");
        }
        if (const std::string doubts = vision::lens_doubts(used.camera.lens); !doubts.empty()) {
          process.log_warning("camera '" + name + "': " + doubts);
        }
        process.on<fathom_lcm::ahrs_t>(wire::kAhrs, wire::kDecode, [&](const Ahrs& sample) { watch.hear(sample); });
        process.on_latest<fathom_lcm::camera_t>(wire::kCamera, wire::kDecode, [&](const Camera& picture) {
          if (picture.camera != name) return;
          if (!watch.see(picture)) process.reject(wire::kCamera);
          for (const TagPose& each : watch.front_end().tag_poses(name)) {
            process.publish(wire::kTagPose, wire::encode(each));
          }
          if (const auto flow = watch.front_end().optical_flow(name)) {
            process.publish(wire::kOpticalFlow, wire::encode(*flow));
          }
          if (const auto range = watch.front_end().laser_range(name)) {
            process.publish(wire::kLaserRange, wire::encode(*range));
          }
          if (debug && seconds_between(drawn, picture.utime) >= debug_every) {
            drawn = picture.utime;
            if (const auto shown = watch.drawing(kDebugQuality))
              process.publish(wire::kCameraDebug, wire::encode(*shown));
          }
          tell();
        });
        process.on_health([&]() -> runtime::Process::Condition {
          return {.unhealthy = watch.complaint(), .detail = watch.counts()};
        });
        process.on_restart([&] {
          watch.reset();
          drawn = 0;
        });
        process.on_end([&] { process.log_info(watch.counts()); });
        process.run();
      },
      [&](runtime::CommandLine& app) {
        app.add_flag("--debug", debug, "publish pictures with everything drawn in");
        app.add_option("--debug-every", debug_every, "seconds between two of them (0.2)")->positive();
      });
}
