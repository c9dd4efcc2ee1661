// supervisor: states, the model and the operator's orders in; commands and what they are for out.
#include <unistd.h>

#include <fathom_lcm/answer_t.hpp>
#include <fathom_lcm/effects_t.hpp>
#include <fathom_lcm/excitation_t.hpp>
#include <fathom_lcm/health_t.hpp>
#include <fathom_lcm/model_t.hpp>
#include <fathom_lcm/operator_t.hpp>
#include <fathom_lcm/state_t.hpp>
#include <fathom_lcm/vehicle_condition_t.hpp>
#include <fathom_lcm/wrench_command_t.hpp>
#include <utility>

#include "common/base/operator_key.hpp"
#include "common/excitation/supervisor.hpp"
#include "common/model/site.hpp"
#include "common/runtime/process.hpp"
#include "common/runtime/self.hpp"
#include "common/runtime/speakers.hpp"
#include "common/wire/channels.hpp"
#include "common/wire/decode.hpp"
#include "common/wire/minds.hpp"
#include "common/wire/signature.hpp"
#include "common/wire/vehicle.hpp"
#include "processes/supervisor/strangers.hpp"

using namespace fathom;

int main(int argc, char** argv) {
  const runtime::Program program{"supervisor",
                                 "Chooses the motions of a trial and keeps the vehicle inside its fence."};
  return runtime::main(program, argc, argv, [](runtime::Process& process) {
    const model::Vehicle vehicle = model::Vehicle::load(process.config_path("dof"));
    const model::Site site = model::Site::load(process.config_path("site"));
    const OperatorKeys keys = operator_keys(process.config_path("operator"));
    excitation::SupervisorSettings settings = excitation::SupervisorSettings::from(process.config(), vehicle, site);
    settings.after_abort = model::AfterAbort::load(process.config_path("dof"));
    excitation::Supervisor supervisor{settings, vehicle};
    // Two supervisors must not look alike to the thrusters.
    const std::string commander = "supervisor " + std::to_string(getpid());
    supervisor::Strangers strangers{commander};
    std::string told;
    const auto tell = [&] {
      const std::string now = std::string{name(supervisor.phase())} + ": " + supervisor.doing();
      if (now == told) return;
      told = now;
      process.log_info(now);
      process.tell_health();
    };

    process.publishes<fathom_lcm::wrench_command_t>(wire::kWrenchCommand);
    process.publishes<fathom_lcm::excitation_t>(wire::kExcitation);
    process.publishes<fathom_lcm::answer_t>(wire::kAnswer);
    process.on<fathom_lcm::state_t>(wire::kState, wire::kDecode, [&](const StateEstimate& state) {
      const auto& output = supervisor.step(state);
      if (output.command) {
        WrenchCommand command = *output.command;
        command.commander = commander;
        const auto said = wire::encode_signed(command, keys.command);
        strangers.sent(said);
        process.publish(wire::kWrenchCommand, said);
      }
      if (output.excitation) process.publish(wire::kExcitation, wire::encode(*output.excitation));
      tell();
    });
    process.on<fathom_lcm::model_t>(wire::kModel, wire::kDecode,
                                    [&](const ModelEstimate& model) { supervisor.hear(model); });
    process.on<fathom_lcm::effects_t>(wire::kEffects, wire::kDecode,
                                      [&](const EffectRanking& effects) { supervisor.hear(effects); });
    // Neither an operator's clock nor that of another host is ours: a jump in it starts nothing over.
    process.listens_to<fathom_lcm::operator_t>(wire::kOperator, [&](const auto& message) {
      const auto order = wire::open(message, keys.order);
      if (!order) return process.reject(wire::kOperator);
      Answer answer = supervisor.hear(*order);
      answer.process = "supervisor";
      process.publish(wire::kAnswer, wire::encode_signed(answer, keys.answer));
      tell();
    });
    process.listens_to<fathom_lcm::answer_t>(wire::kAnswer, [&](const auto& message) {
      const auto answer = wire::open(message, keys.answer);
      if (!answer) return process.reject(wire::kAnswer);
      supervisor.hear(*answer);
    });
    // Who else commands? On a live bus: in lockstep nobody else may, and from a log the commands are those of then.
    if (process.is_live()) {
      process.listens_to<fathom_lcm::wrench_command_t>(wire::kWrenchCommand, [&](const auto& message) {
        if (strangers.heard(message)) {
          process.log_warning(strangers.told());
          process.tell_health();
        }
      });
    }
    // Whether the kernel knows a process is of interest while it lives, not when a log is read.
    runtime::Speakers speakers{process.reads_logs() ? "" : runtime::host_name(), runtime::Speakers::Home::kFirst};
    process.listens_to<fathom_lcm::health_t>(wire::kHealth, [&, warned = false](const auto& message) mutable {
      const auto health = wire::decode(message);
      if (health && speakers.believes(message)) return supervisor.hear(*health);
      if (health && !std::exchange(warned, true)) process.log_warning(runtime::Speakers::kNotBelieved);
      process.reject(wire::kHealth);
    });
    process.listens_to<fathom_lcm::vehicle_condition_t>(wire::kVehicle, [&](const auto& message) {
      const auto vehicle_now = wire::decode(message);
      if (!vehicle_now) return process.reject(wire::kVehicle);
      supervisor.hear(*vehicle_now);
      tell();
    });
    process.on_health([&]() -> runtime::Process::Condition {
      std::string detail = std::string{name(supervisor.phase())} + ": " + supervisor.doing();
      if (const std::string others = strangers.told(); !others.empty()) detail += "; " + others;
      return {.unhealthy = "", .detail = detail};
    });
    process.on_real_time([&](double now) {
      supervisor.watch(now);
      tell();
    });
    process.on_restart([&] { supervisor.reset(); });
    process.run();
  });
}
