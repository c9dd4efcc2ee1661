// fathom methods: the same recordings identified twice, by complementary filters with recursive least squares (Karras
// et al.) and by a Kalman smoother with regression under AR(1) (Pereira and Duncan), in one table.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <iterator>
#include <memory>

#include "common/base/config.hpp"
#include "common/base/error.hpp"
#include "common/consistency/consistency.hpp"
#include "common/diagnosis/prediction.hpp"
#include "common/estimation/corrected_recording.hpp"
#include "common/estimation/estimator.hpp"
#include "common/estimation/process_tuning.hpp"
#include "common/estimation/reconstruct.hpp"
#include "common/estimation/split.hpp"
#include "common/estimation/thruster_forces.hpp"
#include "common/estimation/trial_smoother.hpp"
#include "common/estimation/wording.hpp"
#include "common/identification/base_regression.hpp"
#include "common/identification/identifier.hpp"
#include "processes/fathom/commands.hpp"
#include "processes/fathom/inputs.hpp"
#include "processes/fathom/recordings.hpp"

namespace fathom::tool {
namespace {

struct MethodsOptions {
  std::string vehicle, config, map;
  std::vector<std::string> train, validate;
  bool truth{false};
};

/// Squares of state errors against TRUTH.
struct StateErrors {
  const char* method;
  Eigen::Matrix<double, 5, 1> sum{Eigen::Matrix<double, 5, 1>::Zero()};  // position ... rates, acceleration
  double count{};
  bool accelerations{};
  void add(const StateEstimate& state, const Truth& truth) { add(state.p_WB, state.q_WB, state.nu, truth); }
  void add(const SmoothedState& state, const Truth& truth) {
    add(state.p_WB, state.q_WB, state.nu, truth);
    sum[4] += (state.nu_dot - truth.nu_dot).head<3>().squaredNorm();
    accelerations = true;
  }
  void print() const {
    const Eigen::Matrix<double, 5, 1> rms = (sum / std::max(count, 1.0)).cwiseSqrt();
    std::printf("  %-24s %10.4f %12.4f %13.4f %12.4f ", method, rms[0], rms[1], rms[2], rms[3]);
    accelerations ? std::printf("%18.4f\n", rms[4]) : std::printf("%18s\n", "-");
  }

 private:
  void add(const Eigen::Vector3d& p, const Eigen::Quaterniond& q, const Vector6d& nu, const Truth& truth) {
    const Eigen::Vector3d turn = rotation_vector_from_quaternion(truth.q_WB.conjugate() * q);
    sum.head<4>() += Eigen::Vector4d{(p - truth.p_WB).squaredNorm(), turn.squaredNorm(),
                                     (nu - truth.nu).head<3>().squaredNorm(), (nu - truth.nu).tail<3>().squaredNorm()};
    count += 1.0;
  }
};

template <class State>
void compare(const std::vector<State>& states, const std::vector<Truth>& truth, StateErrors& errors) {
  std::size_t k = 0;
  for (const State& state : states) {
    while (k < truth.size() && truth[k].utime < state.utime) ++k;
    if (k < truth.size() && truth[k].utime == state.utime) errors.add(state, truth[k]);
  }
}

std::vector<StateEstimate> filter(const Recording& recording, const estimation::EstimatorSettings& settings) {
  estimation::Estimator estimator{settings, {}};
  std::vector<StateEstimate> states;
  const auto keep = [&](const estimation::Estimator::Output& output) {
    for (const StateEstimate& one : output) {
      if (one.valid) states.push_back(one);
    }
  };
  std::size_t pose = 0, dvl = 0, depth = 0;
  const auto until = [&](Utime utime) {
    while (pose < recording.pose_capture.size() && recording.pose_capture[pose].utime <= utime) {
      keep(estimator.step(recording.pose_capture[pose++]));
    }
    while (dvl < recording.dvl.size() && recording.dvl[dvl].utime <= utime) keep(estimator.step(recording.dvl[dvl++]));
    while (depth < recording.depth.size() && recording.depth[depth].utime <= utime) {
      keep(estimator.step(recording.depth[depth++]));
    }
  };
  for (const Ahrs& one : recording.ahrs) {
    until(one.utime);
    keep(estimator.step(one));
  }
  keep(estimator.finish());
  return states;
}

std::vector<Thrusters> forces(const Recording& recording, const estimation::Corrections& corrections,
                              const model::Vehicle& vehicle) {
  estimation::ThrusterForces known{corrections.thrusters, vehicle};
  std::vector<Thrusters> result;
  std::size_t battery = 0;
  for (const Thrusters& one : recording.thrusters) {
    while (battery < recording.battery.size() && recording.battery[battery].utime <= one.utime) {
      known.step(recording.battery[battery++]);
    }
    result.push_back(known.step(one));
  }
  return result;
}

void validate(const char* name, const model::Vehicle& vehicle, const std::vector<NamedValue>& parameters,
              std::span<const Trial> trials) {
  model::Model model = model::nominal_model(vehicle, trials.front().input_is_wrench);
  for (const NamedValue& one : parameters) {
    if (const auto parameter = model::parameter_from_name(one.name)) model.theta[model::index(*parameter)] = one.value;
  }
  const auto windows = diagnosis::prediction_windows(trials);
  const auto summary = diagnosis::predict(model, windows).summary(vehicle);
  for (const PredictionError& one : summary) {
    std::printf("  %-34s %4.0f s ahead:", name, one.horizon_s);
    for (std::size_t i = 0; i < 6; ++i) {
      if (vehicle.dof[i]) std::printf("  %s %.4f", model::kVelocityNames[i], one.rmse[i]);
    }
    std::printf("\n");
  }
}

void run_methods(const MethodsOptions& options) {
  const model::Vehicle vehicle = model::Vehicle::load(options.vehicle);
  const Config config = Config::load(options.config);
  const auto filter_settings = estimation::EstimatorSettings::from(config.section("estimator"));
  const auto identifier_settings = identification::IdentifierSettings::from(config.section("identifier"));
  estimation::KalmanSettings kalman;
  kalman.position_noise = filter_settings.position_noise;
  kalman.capture_attitude_noise = filter_settings.attitude_noise;
  kalman.velocity_noise = filter_settings.velocity_noise;
  kalman.depth_noise = filter_settings.depth_noise;
  kalman.gyro_noise.setConstant(filter_settings.rate_noise);
  std::vector<std::string> notes;
  std::vector<std::string> paths = paths_of(options.train);
  const std::size_t fitted_runs = paths.size();
  std::ranges::move(paths_of(options.validate), std::back_inserter(paths));
  std::vector<Recording> recordings = read_recordings(paths, options.map, notes, vehicle.dof);
  auto checked = consistency::check_consistency(recordings);
  consistency::check_thrusters(recordings, vehicle, checked);

  identification::Identifier identifier{identifier_settings, vehicle};
  std::vector<identification::BaseRun> runs;
  StateErrors complementary{"complementary filter"}, forward{"Kalman filter"}, smoothed{"Kalman smoother"};
  for (std::size_t i = 0; i < fitted_runs; ++i) {
    const Recording recording = estimation::corrected(recordings[i], checked.corrections[i]);
    const std::vector<Thrusters> inputs = forces(recording, checked.corrections[i], vehicle);
    if (i == 0) kalman = estimation::tune_process(recording, kalman);
    auto trial = estimation::smooth(recording, kalman);
    const std::vector<StateEstimate> states = filter(recording, filter_settings);
    // Recorded runs may begin at the same time; the identifier hears them one after the other.
    constexpr Utime kApart = 1'000'000'000'000;  // us
    const Utime later = static_cast<Utime>(i) * kApart;
    std::size_t next = 0;
    for (StateEstimate state : states) {
      for (; next < inputs.size() && inputs[next].utime <= state.utime; ++next) {
        Thrusters input = inputs[next];
        input.utime += later;
        static_cast<void>(identifier.step(input));
      }
      state.utime += later;
      static_cast<void>(identifier.step(state));
    }
    compare(states, recording.truth, complementary);
    compare(trial.filtered, recording.truth, forward);
    compare(trial.smoothed, recording.truth, smoothed);
    runs.push_back({std::move(trial.smoothed), inputs});
  }
  const std::vector<NamedValue> recursive = identifier.model().parameters;
  const identification::BaseFit regression = identification::fit_base(vehicle, runs);

  std::printf("process noise by likelihood: jerk %.3g, angular jerk %.3g\n", kalman.process.jerk,
              kalman.process.angular_jerk);
  std::printf("%-10s %24s %24s%s\n", "parameter", "complementary, recursive", "smoother, AR(1)",
              options.truth ? "     truth    errors [%]" : "");
  double squares[2] = {0.0, 0.0};
  for (std::size_t j = 0; j < recursive.size(); ++j) {
    const NamedValue &a = recursive[j], &b = regression.parameters[j];
    std::printf("%-10s %12.4f +- %8.4f %12.4f +- %8.4f", a.name.c_str(), a.value, a.std, b.value, b.std);
    if (options.truth) {
      const double truth = vehicle.priors[j].mean;
      std::printf("  %8.4f  %6.1f %6.1f", truth, 100.0 * (a.value / truth - 1.0), 100.0 * (b.value / truth - 1.0));
      squares[0] += std::pow(a.value / truth - 1.0, 2);
      squares[1] += std::pow(b.value / truth - 1.0, 2);
    }
    std::printf("  %s\n", a.unit.c_str());
  }
  if (options.truth) {
    const auto n = static_cast<double>(recursive.size());
    std::printf("parameter error, root mean square: %.1f %% and %.1f %%\n", 100.0 * std::sqrt(squares[0] / n),
                100.0 * std::sqrt(squares[1] / n));
  }
  if (complementary.count > 0.0) {
    std::printf("state error, root mean square: position [m], attitude [rad], velocity [m/s], rates [rad/s], ");
    std::printf("acceleration [m/s^2]\n");
    for (const StateErrors* one : {&complementary, &forward, &smoothed}) one->print();
  }
  if (options.validate.empty()) return;
  std::vector<Trial> trials;
  for (std::size_t i = fitted_runs; i < recordings.size(); ++i) {
    const Trial run = estimation::reconstruct(recordings[i], checked.corrections[i], vehicle);
    for (Trial& stretch : estimation::known_stretches(run, diagnosis::kHorizons.back()))
      trials.push_back(std::move(stretch));
  }
  if (trials.empty()) {
    throw InputError(options.validate.front() + (options.validate.size() > 1 ? " and its fellows" : "") +
                     estimation::text(": no stretch of %.0f s over which it is known what drove the vehicle; record "
                                      "motion and thrusters together without pauses",
                                      diagnosis::kHorizons.back()));
  }
  std::printf("validation error, m/s and rad/s:\n");
  validate("complementary filter, recursive", vehicle, recursive, trials);
  validate("smoother, regression under AR(1)", vehicle, regression.parameters, trials);
}

}  // namespace

void add_methods(CLI::App& app) {
  auto options = std::make_shared<MethodsOptions>();
  CLI::App* command = app.add_subcommand("methods", "identify recordings by both methods and compare");
  command->add_option("--vehicle", options->vehicle, "vehicle file (YAML)")->required();
  command->add_option("--config", options->config, "pipeline file with sections estimator and identifier")->required();
  command->add_option("--train", options->train, "logs or tables to identify from")->required();
  command->add_option("--validate", options->validate, "logs or tables on which predictions are judged");
  command->add_option("--map", options->map, "column map of .csv files");
  command->add_flag("--truth", options->truth, "the vehicle file's means are the truth (simulated logs)");
  command->callback([options] { run_methods(*options); });
}

}  // namespace fathom::tool
