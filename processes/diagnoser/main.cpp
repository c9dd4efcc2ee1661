// diagnoser: all that `fathom diagnose` reads in a log, the ranking of candidate causes out.
#include <fathom_lcm/ahrs_t.hpp>
#include <fathom_lcm/battery_t.hpp>
#include <fathom_lcm/depth_t.hpp>
#include <fathom_lcm/dvl_t.hpp>
#include <fathom_lcm/effects_t.hpp>
#include <fathom_lcm/learned_t.hpp>
#include <fathom_lcm/model_t.hpp>
#include <fathom_lcm/optical_flow_t.hpp>
#include <fathom_lcm/pose_capture_t.hpp>
#include <fathom_lcm/signal_t.hpp>
#include <fathom_lcm/state_t.hpp>
#include <fathom_lcm/tag_pose_t.hpp>
#include <fathom_lcm/thrusters_t.hpp>

#include "common/live/live_diagnoser.hpp"
#include "common/model/site.hpp"
#include "common/runtime/large_blocks.hpp"
#include "common/runtime/process.hpp"
#include "common/wire/channels.hpp"
#include "common/wire/decode.hpp"
#include "common/wire/minds.hpp"
#include "common/wire/sensors.hpp"
#include "processes/diagnoser/proposals.hpp"

using namespace fathom;

namespace {

/// Where the site is known, and what the supervisor may do there.
std::optional<diagnoser::Proposals> proposals_of(const runtime::Process& process, const model::Vehicle& vehicle,
                                                 const std::optional<model::Site>& site) {
  if (!site || !process.has_config("supervisor")) return {};
  const Config pipeline = Config::load(process.config_path("supervisor"));
  const planning::RehearsalSettings settings{
      .supervisor = excitation::SupervisorSettings::from(pipeline.section("supervisor"), vehicle, *site)};
  return diagnoser::Proposals{planning::LiveSeparation{vehicle, settings}};
}

/// A sensor's clock may leap without the trial beginning anew.
template <class Message>
void hear(runtime::Process& process, live::LiveDiagnoser& diagnoser, const std::string& channel) {
  process.listens_to<Message>(channel, [&process, &diagnoser, channel](const Message& message) {
    const auto sample = wire::decode(message);
    if (!sample) return process.reject(channel);
    diagnoser.hear(*sample);
  });
}

}  // namespace

int main(int argc, char** argv) {
  // A search needs tens of megabytes for a moment: large blocks go back to the system.
  runtime::give_back_large_blocks();
  const runtime::Program program{"diagnoser",
                                 "Ranks the effects that may explain what the model does not, and what to fly next."};
  return runtime::main(program, argc, argv, [](runtime::Process& process) {
    using Late = live::LiveDiagnoser::Late;
    const model::Vehicle vehicle = model::Vehicle::load(process.config_path("dof"));
    std::optional<model::Site> site;
    if (process.has_config("site")) site = model::Site::load(process.config_path("site"));
    std::optional<diagnoser::Proposals> proposals = proposals_of(process, vehicle, site);
    live::LiveDiagnoser diagnoser{live::LiveSettings::from(process.config()), vehicle, site,
                                  process.is_live() ? Late::kIsToldLate : Late::kIsWaitedFor,
                                  [&] { return process.go_on(); }};
    const auto say = [&](std::optional<EffectRanking> ranking) {
      for (const std::string& note : diagnoser.take_notes()) process.log_info(note);
      if (!ranking) return;
      if (proposals) proposals->complete(*ranking, diagnoser.rivals());
      process.publish(wire::kEffects, wire::encode(*ranking));
    };

    process.publishes<fathom_lcm::effects_t>(wire::kEffects);
    process.publishes<fathom_lcm::learned_t>(wire::kLearned);
    process.on<fathom_lcm::state_t>(wire::kState, wire::kDecode,
                                    [&](const StateEstimate& state) { say(diagnoser.step(state)); });
    process.on<fathom_lcm::thrusters_t>(wire::kThrusters, wire::kDecode,
                                        [&](const Thrusters& thrusters) { diagnoser.hear(thrusters); });
    process.on<fathom_lcm::battery_t>(wire::kBattery, wire::kDecode,
                                      [&](const Battery& battery) { diagnoser.hear(battery); });
    hear<fathom_lcm::ahrs_t>(process, diagnoser, wire::kAhrs);
    hear<fathom_lcm::pose_capture_t>(process, diagnoser, wire::kPoseCapture);
    hear<fathom_lcm::dvl_t>(process, diagnoser, wire::kDvl);
    hear<fathom_lcm::depth_t>(process, diagnoser, wire::kDepth);
    hear<fathom_lcm::tag_pose_t>(process, diagnoser, wire::kTagPose);
    if (!vehicle.candidates.empty()) hear<fathom_lcm::signal_t>(process, diagnoser, wire::kSignal);
    hear<fathom_lcm::optical_flow_t>(process, diagnoser, wire::kOpticalFlow);
    process.on<fathom_lcm::model_t>(wire::kModel, wire::kDecode, [&](const ModelEstimate& model) {
      if (proposals) proposals->hear(model);
    });
    process.on_restart([&] {
      diagnoser.reset();
      if (proposals) proposals->reset();
    });
    process.on_end([&] {
      say(diagnoser.finish());
      if (diagnoser.learned()) process.publish(wire::kLearned, wire::encode(*diagnoser.learned()));
    });
    process.run();
  });
}
