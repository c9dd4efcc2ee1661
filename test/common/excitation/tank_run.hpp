// One trial in the tank from arming to the end, and what is to be known of it.
#pragma once

#include <map>
#include <memory>
#include <optional>

#include "common/base/config.hpp"
#include "test/support/tank_plant.hpp"
#include "test/support/virtual_dive.hpp"

namespace fathom::test {

struct TankSettings {
  model::Vehicle vehicle;
  model::Site site;
  excitation::SupervisorSettings supervisor;
  identification::IdentifierSettings identifier;
};

inline TankSettings tank_settings(bool optimal = false) {
  const std::string root = FATHOM_SOURCE_DIR;
  TankSettings s{.vehicle = vehicle_from_repository("seabotix_lbv150"),
                 .site = model::Site::load(root + "/config/sites/tank.yaml"),
                 .supervisor = {},
                 .identifier = {}};
  const Config pipeline = Config::load(root + "/config/pipelines/tank.yaml");
  s.supervisor = excitation::SupervisorSettings::from(pipeline.section("supervisor"), s.vehicle, s.site);
  s.identifier = identification::IdentifierSettings::from(pipeline.section("identifier"));
  if (optimal) {
    s.supervisor.optimal = true;
    s.supervisor.schedule = {{.name = "total", .axis = -1, .threshold = 0.3}};
  }
  return s;
}

struct TankRun {
  double least_room{1e9};  // m
  double ended{};          // s since arming
  std::vector<excitation::Supervisor::Visit> visits;
  ModelEstimate model;
  std::string reason;
  excitation::Phase phase{};
  std::map<std::string, Vector6d> rms_by_mode;  // of nu while excited
  std::map<std::string, double> drift_by_mode;  // m, largest distance of held axes from their place
  double time_to_five_percent{-1.0};            // s, from the information matrix of the true motion
  double bent_share{};
};

struct TankHooks {
  double limit{900.0};  // s
  bool identify{true};
  double noise_share{1.0};  // of R_tau = 1.3 diag(1, 1, 1, 0.05) at 100 Hz, in time_to_five_percent
  std::function<void(double t, TankPlant&, excitation::Supervisor&)> each{};
};

/// Ten parameters that this excitation reveals well: all but Y_v|v|, Z_w|w| and W-B.
inline bool revealed(const std::string& name) { return name != "Y_v|v|" && name != "Z_w|w|" && name != "W-B"; }

inline TankRun tank_run(const TankSettings& s, const PlantOptions& options, const TankHooks& hooks = {}) {
  TankPlant plant{s.vehicle, options};
  auto supervisor_settings = s.supervisor;
  supervisor_settings.seed = options.seed;
  excitation::Supervisor supervisor{ready(supervisor_settings, s.vehicle)};
  identification::Identifier identifier{s.identifier, s.vehicle};
  // The paper's noise and rate: R_tau = 1.3 diag(1, 1, 1, 0.05), 100 Hz, P_0 = 100 I.
  Vector6d noise;
  noise << Eigen::Vector3d::Constant(std::sqrt(1.3 * hooks.noise_share)),
      Eigen::Vector3d::Constant(std::sqrt(1.3 * 0.05 * hooks.noise_share));
  excitation::Information information{s.vehicle, noise};
  const auto n = static_cast<Eigen::Index>(s.vehicle.parameters.size());
  TankRun run;
  std::map<std::string, double> counts;
  double bent = 0.0, excited = 0.0;
  bool armed = false;
  std::string mode;
  bool exciting = false;
  Eigen::Vector3d place = Eigen::Vector3d::Zero();
  while (plant.seconds() < hooks.limit) {
    const StateEstimate state = plant.state();
    if (hooks.identify) {
      for (const auto& model : identifier.step(state).models) supervisor.hear(model);
      for (const auto& model : identifier.step(plant.thrusters()).models) supervisor.hear(model);
    }
    if (hooks.each) hooks.each(plant.seconds(), plant, supervisor);
    const auto& output = supervisor.step(state);
    if (output.command) plant.command(*output.command);
    if (output.excitation) {
      identifier.hear(*output.excitation);
      if (output.excitation->active && !exciting) place = plant.position();
      exciting = output.excitation->active;
      mode = output.excitation->mode;
      bent += exciting && output.excitation->bent ? 1.0 : 0.0;
      excited += exciting ? 1.0 : 0.0;
    }
    if (!armed && plant.seconds() > 0.5) {
      supervisor.hear(order_to_arm(plant.utime()));
      armed = true;
    }
    plant.step();
    run.least_room = std::min(run.least_room, plant.room(s.site));
    if (exciting) {
      counts[mode] += 1.0;
      auto& rms = run.rms_by_mode.try_emplace(mode, Vector6d::Zero()).first->second;
      rms += plant.nu().cwiseAbs2();
      double& drift = run.drift_by_mode[mode];
      if (mode == "yaw" || mode == "heave") drift = std::max(drift, (plant.position() - place).head<2>().norm());
      if (mode == "surge" || mode == "sway" || mode == "yaw")
        drift = std::max(drift, std::abs(plant.position().z() - place.z()));
    }
    if (armed) {
      information.add(plant.nu_dot(), plant.middle_nu(), plant.attitude().toRotationMatrix(), 1.0);
      if (run.time_to_five_percent < 0.0 && static_cast<int>(std::lround(100.0 * plant.seconds())) % 50 == 0) {
        Eigen::MatrixXd all = information.matrix();
        all.diagonal().array() += 0.01;
        const Eigen::MatrixXd P = all.ldlt().solve(Eigen::MatrixXd::Identity(n, n));
        double worst = 0.0;
        for (Eigen::Index i = 0; i < n; ++i) {
          const auto k = static_cast<std::size_t>(i);
          if (revealed(s.vehicle.parameters[k]))
            worst = std::max(worst, std::sqrt(P(i, i)) / std::abs(s.vehicle.priors[k].mean));
        }
        if (worst < 0.05) run.time_to_five_percent = plant.seconds() - 0.5;
      }
    }
    using excitation::Phase;
    if (armed && plant.seconds() > 1.0 &&
        (supervisor.phase() == Phase::kAborted ||
         (supervisor.phase() == Phase::kDone && supervisor.visits().size() == s.supervisor.schedule.size() &&
          !output.command)))
      break;
  }
  for (auto& [name, rms] : run.rms_by_mode) rms = (rms / counts[name]).cwiseSqrt();
  run.ended = plant.seconds() - 0.5;
  run.visits = supervisor.visits();
  run.model = identifier.model();
  run.reason = supervisor.reason();
  run.phase = supervisor.phase();
  run.bent_share = excited > 0.0 ? bent / excited : 0.0;
  return run;
}

}  // namespace fathom::test
