// estimator: what the sensors say in, STATE out; complementary filters, or a Kalman filter where the configuration says
// `filter: ekf`.
#include <fathom_lcm/ahrs_t.hpp>
#include <fathom_lcm/depth_t.hpp>
#include <fathom_lcm/dvl_t.hpp>
#include <fathom_lcm/pose_capture_t.hpp>
#include <fathom_lcm/ranges_t.hpp>
#include <fathom_lcm/state_t.hpp>
#include <fathom_lcm/tag_pose_t.hpp>
#include <fathom_lcm/usbl_t.hpp>

#include "common/base/config.hpp"
#include "common/estimation/corrections_file.hpp"
#include "common/estimation/estimator.hpp"
#include "common/estimation/kalman_estimator.hpp"
#include "common/runtime/process.hpp"
#include "common/wire/channels.hpp"
#include "common/wire/minds.hpp"
#include "common/wire/sensors.hpp"

using namespace fathom;

namespace {

template <class Message, class Mind>
void hear(runtime::Process& process, Mind& mind, const std::string& channel) {
  process.on<Message>(channel, [&process, &mind, channel](const Message& message) {
    const auto sample = wire::decode(message);
    if (!sample) return process.reject(channel);
    for (const StateEstimate& state : mind.step(*sample)) process.publish(wire::kState, wire::encode(state));
  });
}

template <class Mind>
void hear_common(runtime::Process& process, Mind& mind) {
  process.publishes<fathom_lcm::state_t>(wire::kState);
  hear<fathom_lcm::pose_capture_t>(process, mind, wire::kPoseCapture);
  hear<fathom_lcm::ahrs_t>(process, mind, wire::kAhrs);
  hear<fathom_lcm::dvl_t>(process, mind, wire::kDvl);
  hear<fathom_lcm::depth_t>(process, mind, wire::kDepth);
}

template <class Mind>
void run(runtime::Process& process, Mind& mind) {
  process.on_restart([&] { mind.reset(); });
  process.on_end([&] {
    for (const StateEstimate& state : mind.finish()) process.publish(wire::kState, wire::encode(state));
    for (const auto& [reason, count] : mind.rejected()) {
      process.log_info(std::to_string(count) + " samples not used: " + reason);
    }
  });
  process.run();
}

}  // namespace

int main(int argc, char** argv) {
  return runtime::main("estimator", argc, argv, [](runtime::Process& process) {
    const Config& config = process.config();
    if (config.has("filter") && config.either("filter", "ekf", "complementary")) {
      estimation::KalmanEstimator estimator{estimation::KalmanSettings::from(config)};
      hear_common(process, estimator);
      hear<fathom_lcm::usbl_t>(process, estimator, wire::kUsbl);
      hear<fathom_lcm::ranges_t>(process, estimator, wire::kRanges);
      hear<fathom_lcm::tag_pose_t>(process, estimator, wire::kTagPose);
      run(process, estimator);
      return;
    }
    estimation::Estimator estimator{estimation::EstimatorSettings::from(config),
                                    estimation::load_corrections(process.config_path("corrections"))};
    hear_common(process, estimator);
    run(process, estimator);
  });
}
