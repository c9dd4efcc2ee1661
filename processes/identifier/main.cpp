// identifier: states and thruster commands in, the vehicle's parameters and what they leave unexplained out. With
// `estimate: joint` it hears the instruments as well, and MODEL has the numbers of a filter on state and parameters.
#include <cstdio>
#include <fathom_lcm/ahrs_t.hpp>
#include <fathom_lcm/battery_t.hpp>
#include <fathom_lcm/depth_t.hpp>
#include <fathom_lcm/dvl_t.hpp>
#include <fathom_lcm/effects_t.hpp>
#include <fathom_lcm/excitation_t.hpp>
#include <fathom_lcm/laser_range_t.hpp>
#include <fathom_lcm/model_t.hpp>
#include <fathom_lcm/optical_flow_t.hpp>
#include <fathom_lcm/residual_t.hpp>
#include <fathom_lcm/state_t.hpp>
#include <fathom_lcm/tag_pose_t.hpp>
#include <fathom_lcm/thrusters_t.hpp>
#include <fathom_lcm/usbl_t.hpp>
#include <fstream>
#include <iterator>
#include <memory>
#include <optional>

#include "common/estimation/corrections_file.hpp"
#include "common/estimation/thruster_forces.hpp"
#include "common/joint/live_identifier.hpp"
#include "common/model/site.hpp"
#include "common/runtime/command_line.hpp"
#include "common/runtime/process.hpp"
#include "common/wire/channels.hpp"
#include "common/wire/decode.hpp"
#include "common/wire/minds.hpp"
#include "common/wire/sensors.hpp"

using namespace fathom;

namespace {

constexpr double kPushed = 1.0;          // s that the newest THRUSTERS may be older than STATE
constexpr double kSavePeriod = 2.0;      // s of message time between two savings
constexpr double kResumeWithin = 120.0;  // s that a saved state may be older than the first state heard

std::string content(const std::string& path) {
  std::ifstream file{path};
  return {std::istreambuf_iterator<char>{file}, {}};
}

// Whole or not at all: a process that is killed while it writes leaves the file of before.
void save(const std::string& path, const std::string& text) {
  const std::string fresh = path + ".new";
  std::ofstream file{fresh, std::ios::trunc};
  file << text;
  file.close();
  if (file) std::rename(fresh.c_str(), path.c_str());
}

/// The joint estimate rests on what the estimator rests on, with the noise that its section states.
std::unique_ptr<joint::LiveIdentifier> make(const runtime::Process& process, const Config& config,
                                            const model::Vehicle& vehicle) {
  const auto settings = identification::IdentifierSettings::from(config);
  const std::optional<joint::JointSettings> joint =
      config.has("joint") ? std::optional{joint::JointSettings::from(config.section("joint"))} : std::nullopt;
  if (!settings.joint) return std::make_unique<joint::LiveIdentifier>(settings, vehicle);
  if (!joint) config.fail("estimate", "'estimate: joint' needs a section 'joint'; see docs/configuration.md");
  const Config estimator = Config::load(process.config_path("estimator")).section("estimator");
  if (!estimator.has("filter") || estimator.text("filter") != "complementary")
    config.fail("estimate",
                "'estimate: joint' needs the estimator's 'filter: complementary', whose noise figures it uses");
  const model::Site site = model::Site::load(process.config_path("site"));
  return std::make_unique<joint::LiveIdentifier>(settings, vehicle, *joint,
                                                 estimation::NavigatorSettings::from(estimator),
                                                 estimation::NavigatorPlaces::of(vehicle.mounts, site));
}

/// An instrument beside STATE, whose clock is this process's.
template <class Message>
void hear(runtime::Process& process, joint::LiveIdentifier& identifier, const std::string& channel) {
  process.listens_to<Message>(channel, [&process, &identifier, channel](const Message& message) {
    const auto sample = wire::decode(message);
    if (!sample) return process.reject(channel);
    identifier.hear(*sample);
  });
}

/// Only where the joint estimate wants them: a hundred messages a second are much beside what the recursive one needs.
void hear_instruments(runtime::Process& process, joint::LiveIdentifier& identifier) {
  hear<fathom_lcm::ahrs_t>(process, identifier, wire::kAhrs);
  hear<fathom_lcm::tag_pose_t>(process, identifier, wire::kTagPose);
  hear<fathom_lcm::optical_flow_t>(process, identifier, wire::kOpticalFlow);
  hear<fathom_lcm::laser_range_t>(process, identifier, wire::kLaserRange);
  hear<fathom_lcm::dvl_t>(process, identifier, wire::kDvl);
  hear<fathom_lcm::usbl_t>(process, identifier, wire::kUsbl);
  hear<fathom_lcm::depth_t>(process, identifier, wire::kDepth);
}

}  // namespace

int main(int argc, char** argv) {
  std::string saved;
  const auto setup = [&](runtime::Process& process) {
    const model::Vehicle vehicle = model::Vehicle::load(process.config_path("dof"));
    const estimation::Corrections corrections = estimation::load_corrections(process.config_path("corrections"));
    const Config config = process.config();
    const std::unique_ptr<joint::LiveIdentifier> mind = make(process, config, vehicle);
    joint::LiveIdentifier& identifier = *mind;
    if (config.has("save") && saved.empty()) saved = config.text("save");
    if (!saved.empty()) identifier.offer(content(saved), kResumeWithin);
    Utime last_save{};
    bool resumed = false;
    std::optional<Utime> pushed;  // of the newest THRUSTERS, or the first STATE before there were any
    double unpushed = 0.0;        // s
    bool told_silent = false;
    estimation::ThrusterForces forces{corrections.thrusters, vehicle};
    const auto say = [&](const joint::LiveIdentifier::Output& output) {
      for (const Residual& residual : output.residuals) process.publish(wire::kResidual, wire::encode(residual));
      for (const ModelEstimate& model : output.models) process.publish(wire::kModel, wire::encode(model));
      if (!resumed && identifier.resumed()) {
        resumed = true;
        process.log_info("goes on from " + saved);
      }
      if (saved.empty() || output.models.empty()) return;
      const Utime now = output.models.back().utime;
      if (seconds_between(last_save, now) >= 0.0 && seconds_between(last_save, now) < kSavePeriod) return;
      last_save = now;
      save(saved, identifier.save_text());
    };

    process.publishes<fathom_lcm::model_t>(wire::kModel);
    process.publishes<fathom_lcm::residual_t>(wire::kResidual);
    process.on<fathom_lcm::state_t>(wire::kState, wire::kDecode, [&](const StateEstimate& state) {
      say(identifier.step(state));
      unpushed = seconds_between(pushed.value_or(state.utime), state.utime);
      if (!pushed) pushed = state.utime;
      if (const bool silent = unpushed > kPushed; silent != told_silent) {
        told_silent = silent;
        process.tell_health();
      }
    });
    process.on<fathom_lcm::thrusters_t>(wire::kThrusters, wire::kDecode, [&](const Thrusters& thrusters) {
      pushed = thrusters.utime;
      say(identifier.step(forces.step(thrusters)));
    });
    process.on<fathom_lcm::battery_t>(wire::kBattery, wire::kDecode, [&](const Battery& battery) {
      forces.step(battery);
      identifier.hear(battery);
    });
    process.on<fathom_lcm::effects_t>(wire::kEffects, wire::kDecode,
                                      [&](const EffectRanking& ranking) { identifier.hear(ranking); });
    process.on<fathom_lcm::excitation_t>(wire::kExcitation, wire::kDecode,
                                         [&](const Excitation& excitation) { identifier.hear(excitation); });
    if (identifier.joint() != nullptr) hear_instruments(process, identifier);
    process.on_health([&]() -> runtime::Process::Condition {
      if (unpushed <= kPushed) return {};
      return {.unhealthy = "THRUSTERS is silent: without what they gave nothing can be learnt; is their driver well?"};
    });
    process.on_restart([&] {
      pushed.reset();
      unpushed = 0.0;
      identifier.reset();
      forces.reset();
    });
    process.on_end([&] {
      say(identifier.finish());
      for (const auto& [reason, count] : identifier.rejected()) {
        process.log_info(std::to_string(count) + " samples not used: " + reason);
      }
    });
    process.run();
  };
  const runtime::Program program{"identifier", "Identifies the parameters of the vehicle's model on line."};
  return runtime::main(program, argc, argv, setup, [&](runtime::CommandLine& app) {
    app.add_option("--save", saved, "file to go on from after an interruption; instead of the section's key");
  });
}
