// simulator: WRENCH_COMMAND, OPERATOR and EXCITATION (to know when a trial is over) in; every instrument's channel,
// THRUSTERS, and TRUTH for plots out. With --manoeuvre a preset is flown instead of commands. With --bytes the drivers'
// channels stay silent: their instruments are played.
#include <fathom_lcm/answer_t.hpp>
#include <fathom_lcm/excitation_t.hpp>
#include <fathom_lcm/operator_t.hpp>
#include <fathom_lcm/wrench_command_t.hpp>

#include "common/base/config.hpp"
#include "common/base/error.hpp"
#include "common/base/operator_key.hpp"
#include "common/wire/channels.hpp"
#include "common/wire/decode.hpp"
#include "common/wire/minds.hpp"
#include "common/wire/signature.hpp"
#include "processes/simulator/speech.hpp"
#include "processes/simulator/stage.hpp"
#include "processes/simulator/truth_file.hpp"

using namespace fathom;

namespace {

void declare(runtime::Process& process) {
  simulator::declare_speech(process);
  process.publishes<fathom_lcm::operator_t>(wire::kOperator);
  process.publishes<fathom_lcm::answer_t>(wire::kAnswer);
  process.publishes<fathom_lcm::lockstep_t>(runtime::kLockstep);
}

model::ManoeuvrePilot pilot_of(const std::string& name, const model::Vehicle& vehicle,
                               const simulation::Simulator& simulator) {
  if (vehicle.thrusters.size() != 2 || !vehicle.curve.empty()) {
    throw InputError("--manoeuvre: flown with two thrusters that are told forces, and " + vehicle.name + " has others");
  }
  model::Manoeuvre manoeuvre = model::manoeuvre_preset(name);
  manoeuvre.heading = euler_from_rotation(simulator.moment().R_WB).z();
  return model::ManoeuvrePilot{manoeuvre};
}

}  // namespace

int main(int argc, char** argv) {
  simulator::Options options;
  const runtime::Program program{
      "simulator", "Stands in for the vehicle: water, thrusters, instruments, and effects hidden in the truth."};
  return runtime::main(
      program, argc, argv,
      [&](runtime::Process& process) {
        options.check();
        options.setup.raw = !options.drivers.empty();
        options.keys = operator_keys(process.config_path("operator"));
        const model::Vehicle vehicle = model::Vehicle::load(process.config_path("dof"));
        const model::Site site = model::Site::load(process.config_path("site"));
        const Config config = process.config();
        simulation::Simulator simulator{vehicle, site, config, options.setup};
        simulator::Darkroom darkroom{vehicle, site, config, options.setup};
        if (!options.camera_at.empty()) darkroom.open_line(options.camera_at);
        std::optional<simulator::Instruments> instruments;
        if (!options.drivers.empty()) instruments.emplace(options.drivers, vehicle, simulator.sensors());
        std::optional<model::ManoeuvrePilot> pilot;
        if (!options.manoeuvre.empty()) pilot = pilot_of(options.manoeuvre, vehicle, simulator);
        simulator::Stage stage{process, simulator, darkroom, options, instruments ? &*instruments : nullptr, pilot};
        declare(process);
        process.listens_to<fathom_lcm::wrench_command_t>(wire::kWrenchCommand, [&](const auto& message) {
          stage.count_command();
          const auto command = wire::open(message, options.keys.command);
          if (!command) return process.reject(wire::kWrenchCommand);
          stage.hear(*command);
        });
        process.listens_to<fathom_lcm::excitation_t>(wire::kExcitation, [&](const auto& message) {
          const auto excitation = wire::decode(message);
          if (!excitation) process.reject(wire::kExcitation);
          stage.hear(excitation.value_or(Excitation{}));  // one that cannot be read is counted all the same
        });
        process.on<fathom_lcm::operator_t>(
            wire::kOperator, [&](const auto& message) { return wire::open(message, options.keys.order); },
            [&](const Operator& order) { stage.hear(order); });
        process.listens_to<fathom_lcm::answer_t>(wire::kAnswer, [&](const auto& message) {
          if (const auto answer = wire::open(message, options.keys.answer)) stage.hear(*answer);
        });
        process.listens_to<fathom_lcm::lockstep_ack_t>(runtime::kLockstepAck,
                                                       [&](const auto& ack) { stage.hear(ack); });
        process.listens_to<fathom_lcm::process_info_t>("PROCESS_INFO", [&](const auto& info) { stage.hear(info); });
        process.listens_to<fathom_lcm::health_t>("HEALTH", [&](const auto& health) { stage.hear(health); });
        process.waits_with([&](std::span<const int> descriptors, int ms) { stage.wait(descriptors, ms); });
        process.on_health([&] { return stage.condition(); });
        process.on_end([&] {
          stage.end();
          write_truth(options, vehicle, site, simulator);
        });
        process.run();
      },
      [&](runtime::CommandLine& app) { options.add_to(app); });
}
