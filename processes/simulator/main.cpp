// simulator: WRENCH_COMMAND, OPERATOR and EXCITATION (to know when a trial is over) in; every instrument's channel,
// THRUSTERS, and TRUTH for plots out.
#include <fathom_lcm/ahrs_t.hpp>
#include <fathom_lcm/battery_t.hpp>
#include <fathom_lcm/camera_t.hpp>
#include <fathom_lcm/depth_t.hpp>
#include <fathom_lcm/dvl_t.hpp>
#include <fathom_lcm/excitation_t.hpp>
#include <fathom_lcm/laser_range_t.hpp>
#include <fathom_lcm/loads_t.hpp>
#include <fathom_lcm/operator_t.hpp>
#include <fathom_lcm/optical_flow_t.hpp>
#include <fathom_lcm/pose_capture_t.hpp>
#include <fathom_lcm/ranges_t.hpp>
#include <fathom_lcm/tag_pose_t.hpp>
#include <fathom_lcm/thrusters_t.hpp>
#include <fathom_lcm/truth_t.hpp>
#include <fathom_lcm/usbl_t.hpp>
#include <fathom_lcm/wrench_command_t.hpp>

#include "common/base/config.hpp"
#include "common/base/error.hpp"
#include "common/base/operator_token.hpp"
#include "common/wire/channels.hpp"
#include "common/wire/minds.hpp"
#include "processes/simulator/stage.hpp"
#include "processes/simulator/truth_file.hpp"

using namespace fathom;

namespace {

void declare(runtime::Process& process) {
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
  process.publishes<fathom_lcm::camera_t>(wire::kCamera);
  process.publishes<fathom_lcm::truth_t>(wire::kTruth);
  process.publishes<fathom_lcm::operator_t>(wire::kOperator);
  process.publishes<fathom_lcm::lockstep_t>(runtime::kLockstep);
}

}  // namespace

int main(int argc, char** argv) {
  simulator::Options options;
  return runtime::main(
      "simulator", argc, argv,
      [&](runtime::Process& process) {
        options.check();
        options.token = operator_token(process.config_path("operator"));
        const model::Vehicle vehicle = model::Vehicle::load(process.config_path("dof"));
        const model::Site site = model::Site::load(process.config_path("site"));
        const Config config = process.config();
        simulation::Simulator simulator{vehicle, site, config, options.setup};
        simulator::Darkroom darkroom{vehicle, site, config, options.setup};
        simulator::Stage stage{process, simulator, darkroom, options};
        declare(process);
        process.on<fathom_lcm::wrench_command_t>(wire::kWrenchCommand, [&](const auto& message) {
          stage.count_command();
          const auto command = wire::decode(message);
          if (!command) return process.reject(wire::kWrenchCommand);
          stage.hear(*command);
        });
        process.on<fathom_lcm::excitation_t>(wire::kExcitation, [&](const auto& message) {
          const auto excitation = wire::decode(message);
          if (!excitation) process.reject(wire::kExcitation);
          stage.hear(excitation.value_or(Excitation{}));  // one that cannot be read is counted all the same
        });
        process.on<fathom_lcm::operator_t>(wire::kOperator, [&](const auto& message) {
          const auto order = wire::decode(message);
          if (!order) return process.reject(wire::kOperator);
          stage.hear(*order);
        });
        process.on<fathom_lcm::lockstep_ack_t>(runtime::kLockstepAck, [&](const auto& ack) { stage.hear(ack); });
        process.on<fathom_lcm::process_info_t>("PROCESS_INFO", [&](const auto& info) { stage.hear(info); });
        process.on<fathom_lcm::health_t>("HEALTH", [&](const auto& health) { stage.hear(health); });
        process.waits_with([&](std::span<const int> descriptors, int ms) { stage.wait(descriptors, ms); });
        process.on_health([&] { return stage.condition(); });
        process.on_end([&] {
          stage.end();
          write_truth(options, vehicle, site, simulator);
        });
        process.run();
      },
      [&](CLI::App& app) { options.add_to(app); });
}
