// identifier: states and thruster commands in, the vehicle's parameters and what they leave unexplained out.
#include <fathom_lcm/battery_t.hpp>
#include <fathom_lcm/model_t.hpp>
#include <fathom_lcm/residual_t.hpp>
#include <fathom_lcm/state_t.hpp>
#include <fathom_lcm/thrusters_t.hpp>

#include "common/estimation/corrections_file.hpp"
#include "common/estimation/thruster_forces.hpp"
#include "common/identification/identifier.hpp"
#include "common/runtime/process.hpp"
#include "common/wire/channels.hpp"
#include "common/wire/minds.hpp"
#include "common/wire/sensors.hpp"

using namespace fathom;

int main(int argc, char** argv) {
  return runtime::main("identifier", argc, argv, [](runtime::Process& process) {
    const model::Vehicle vehicle = model::Vehicle::load(process.config_path("dof"));
    const estimation::Corrections corrections = estimation::load_corrections(process.config_path("corrections"));
    identification::Identifier identifier{identification::IdentifierSettings::from(process.config()), vehicle};
    estimation::ThrusterForces forces{corrections.thrusters, vehicle};
    const auto say = [&](const identification::Identifier::Output& output) {
      for (const Residual& residual : output.residuals) process.publish(wire::kResidual, wire::encode(residual));
      for (const ModelEstimate& model : output.models) process.publish(wire::kModel, wire::encode(model));
    };

    process.publishes<fathom_lcm::model_t>(wire::kModel);
    process.publishes<fathom_lcm::residual_t>(wire::kResidual);
    process.on<fathom_lcm::state_t>(wire::kState, [&](const auto& message) {
      const auto state = wire::decode(message);
      if (!state) return process.reject(wire::kState);
      say(identifier.step(*state));
    });
    process.on<fathom_lcm::thrusters_t>(wire::kThrusters, [&](const auto& message) {
      const auto thrusters = wire::decode(message);
      if (!thrusters) return process.reject(wire::kThrusters);
      say(identifier.step(forces.step(*thrusters)));
    });
    process.on<fathom_lcm::battery_t>(wire::kBattery, [&](const auto& message) {
      const auto battery = wire::decode(message);
      if (!battery) return process.reject(wire::kBattery);
      forces.step(*battery);
    });
    process.on_restart([&] {
      identifier.reset();
      forces.reset();
    });
    process.on_end([&] {
      for (const auto& [reason, count] : identifier.rejected()) {
        process.log_info(std::to_string(count) + " samples not used: " + reason);
      }
    });
    process.run();
  });
}
