// estimator: what the sensors say in, STATE out.
#include <fathom_lcm/ahrs_t.hpp>
#include <fathom_lcm/depth_t.hpp>
#include <fathom_lcm/dvl_t.hpp>
#include <fathom_lcm/pose_capture_t.hpp>
#include <fathom_lcm/state_t.hpp>

#include "common/estimation/corrections_file.hpp"
#include "common/estimation/estimator.hpp"
#include "common/runtime/process.hpp"
#include "common/wire/channels.hpp"
#include "common/wire/minds.hpp"
#include "common/wire/sensors.hpp"

using namespace fathom;

namespace {

template <class Message>
void hear(runtime::Process& process, estimation::Estimator& estimator, const std::string& channel) {
  process.on<Message>(channel, [&process, &estimator, channel](const Message& message) {
    const auto sample = wire::decode(message);
    if (!sample) return process.reject(channel);
    for (const StateEstimate& state : estimator.step(*sample)) process.publish(wire::kState, wire::encode(state));
  });
}

}  // namespace

int main(int argc, char** argv) {
  return runtime::main("estimator", argc, argv, [](runtime::Process& process) {
    estimation::Estimator estimator{estimation::EstimatorSettings::from(process.config()),
                                    estimation::load_corrections(process.config_path("corrections"))};
    process.publishes<fathom_lcm::state_t>(wire::kState);
    hear<fathom_lcm::pose_capture_t>(process, estimator, wire::kPoseCapture);
    hear<fathom_lcm::ahrs_t>(process, estimator, wire::kAhrs);
    hear<fathom_lcm::dvl_t>(process, estimator, wire::kDvl);
    hear<fathom_lcm::depth_t>(process, estimator, wire::kDepth);
    process.on_restart([&] { estimator.reset(); });
    process.on_end([&] {
      for (const StateEstimate& state : estimator.finish()) process.publish(wire::kState, wire::encode(state));
      for (const auto& [reason, count] : estimator.rejected()) {
        process.log_info(std::to_string(count) + " samples not used: " + reason);
      }
    });
    process.run();
  });
}
