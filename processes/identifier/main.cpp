// identifier: states and thruster commands in, the vehicle's parameters and what they leave unexplained out.
#include <CLI/CLI.hpp>
#include <cstdio>
#include <fathom_lcm/battery_t.hpp>
#include <fathom_lcm/effects_t.hpp>
#include <fathom_lcm/excitation_t.hpp>
#include <fathom_lcm/model_t.hpp>
#include <fathom_lcm/residual_t.hpp>
#include <fathom_lcm/state_t.hpp>
#include <fathom_lcm/thrusters_t.hpp>
#include <fstream>
#include <iterator>

#include "common/estimation/corrections_file.hpp"
#include "common/estimation/thruster_forces.hpp"
#include "common/identification/identifier.hpp"
#include "common/runtime/process.hpp"
#include "common/wire/channels.hpp"
#include "common/wire/minds.hpp"
#include "common/wire/sensors.hpp"

using namespace fathom;

namespace {

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

}  // namespace

int main(int argc, char** argv) {
  std::string saved;
  const auto setup = [&](runtime::Process& process) {
    const model::Vehicle vehicle = model::Vehicle::load(process.config_path("dof"));
    const estimation::Corrections corrections = estimation::load_corrections(process.config_path("corrections"));
    const Config config = process.config();
    identification::Identifier identifier{identification::IdentifierSettings::from(config), vehicle};
    if (config.has("save") && saved.empty()) saved = config.text("save");
    if (!saved.empty()) identifier.offer(content(saved), kResumeWithin);
    Utime last_save{};
    bool resumed = false;
    estimation::ThrusterForces forces{corrections.thrusters, vehicle};
    const auto say = [&](const identification::Identifier::Output& output) {
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
      identifier.hear(*battery);
    });
    process.on<fathom_lcm::effects_t>(wire::kEffects, [&](const auto& message) {
      const auto ranking = wire::decode(message);
      if (!ranking) return process.reject(wire::kEffects);
      identifier.hear(*ranking);
    });
    process.on<fathom_lcm::excitation_t>(wire::kExcitation, [&](const auto& message) {
      const auto excitation = wire::decode(message);
      if (!excitation) return process.reject(wire::kExcitation);
      identifier.hear(*excitation);
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
  };
  return runtime::main("identifier", argc, argv, setup, [&](CLI::App& app) {
    app.add_option("--save", saved, "file to go on from after an interruption; instead of the section's key");
  });
}
