// fathom methods: the same recordings identified twice, by complementary filters with recursive least squares (Karras
// et al.) and by a Kalman smoother with regression under AR(1) (Pereira and Duncan), in one table.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <iterator>
#include <memory>
#include <optional>
#include <ranges>

#include "common/base/error.hpp"
#include "common/consistency/consistency.hpp"
#include "common/estimation/corrected_recording.hpp"
#include "common/estimation/online/estimator.hpp"
#include "common/estimation/reconstruct.hpp"
#include "common/estimation/smoothing/state_reconstruction.hpp"
#include "common/estimation/split.hpp"
#include "common/estimation/thruster_forces.hpp"
#include "common/estimation/wording.hpp"
#include "common/identification/identifier.hpp"
#include "common/identification/regression/base_regression.hpp"
#include "common/residual/prediction.hpp"
#include "common/runtime/command_line.hpp"
#include "processes/fathom/bus/trial_files.hpp"
#include "processes/fathom/commands.hpp"
#include "processes/fathom/data/command_units.hpp"
#include "processes/fathom/inputs.hpp"
#include "processes/fathom/recordings.hpp"

namespace fathom::tool {
namespace {

struct MethodsOptions {
  std::string vehicle, config, site, map;
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

/// The truth is told less often than states are, and between their times: it goes on to the next state's by itself.
template <class State>
void compare(const std::vector<State>& states, const std::vector<Truth>& truths, StateErrors& errors) {
  constexpr double kNext = 0.02;  // s
  std::size_t k = 0;
  for (Truth truth : truths) {
    while (k < states.size() && states[k].utime < truth.utime) ++k;
    if (k == states.size()) break;
    const double dt = seconds_between(truth.utime, states[k].utime);
    if (dt > kNext) continue;
    if constexpr (requires { states[k].valid; }) {
      if (!states[k].valid) continue;
    }
    if (dt > 0.0) {
      truth.p_WB += dt * (truth.q_WB * truth.nu.head<3>());
      truth.q_WB = truth.q_WB * quaternion_from_rotation_vector(dt * truth.nu.tail<3>());
      truth.nu += dt * truth.nu_dot;
    }
    errors.add(states[k], truth);
  }
}

std::vector<StateEstimate> filtered(const Recording& recording, const estimation::EstimatorSettings& settings) {
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
  const auto windows = residual::prediction_windows(trials);
  const auto summary = residual::predict(model, windows).summary(vehicle);
  for (const PredictionError& one : summary) {
    std::printf("  %-34s %4.0f s ahead:", name, one.horizon_s);
    for (std::size_t i = 0; i < 6; ++i) {
      if (vehicle.dof[i]) std::printf("  %s %.4f", model::kVelocityNames[i], one.rmse[i]);
    }
    std::printf("\n");
  }
}

/// One estimator's states of all runs, and what the recursive estimate makes of them.
struct Method {
  const char* name;
  std::vector<std::vector<StateEstimate>> runs;  ///< one list per recording
  StateErrors errors;
  std::vector<NamedValue> parameters;
};

std::vector<StateEstimate> states_of(const std::vector<SmoothedState>& smoothed) {
  std::vector<StateEstimate> states;
  for (const SmoothedState& one : smoothed) {
    StateEstimate& state = states.emplace_back(StateEstimate{.utime = one.utime,
                                                             .p_WB = one.p_WB,
                                                             .q_WB = one.q_WB,
                                                             .nu = one.nu,
                                                             .sigma = one.sigma.head<12>(),
                                                             .valid = true});
    state.covariance.diagonal() << one.sigma.head<3>().cwiseAbs2(), one.sigma.segment<3>(6).cwiseAbs2();
  }
  return states;
}

/// Recursive least squares on one estimator's states. Nothing when no row could be used: the result would be the prior.
std::optional<ModelEstimate> recursive(const identification::IdentifierSettings& settings,
                                       const model::Vehicle& vehicle, const Method& method,
                                       const std::vector<std::vector<Thrusters>>& inputs) {
  identification::Identifier identifier{settings, vehicle};
  for (std::size_t i = 0; i < method.runs.size(); ++i) {
    // Recorded runs may begin at the same time; the identifier hears them one after the other.
    constexpr Utime kApart = 1'000'000'000'000;  // us
    const Utime later = static_cast<Utime>(i) * kApart;
    std::size_t next = 0;
    for (StateEstimate state : method.runs[i]) {
      for (; next < inputs[i].size() && inputs[i][next].utime <= state.utime; ++next) {
        Thrusters input = inputs[i][next];
        input.utime += later;
        static_cast<void>(identifier.step(input));
      }
      state.utime += later;
      static_cast<void>(identifier.step(state));
    }
  }
  ModelEstimate model = identifier.model();
  return model.updates > 0 ? std::optional{std::move(model)} : std::nullopt;
}

void print_parameters(const std::vector<Method>& methods, const identification::BaseFit& regression,
                      const model::Vehicle& vehicle, bool truth) {
  std::printf("%-10s", "parameter");
  for (const Method& one : methods) std::printf(" %24s", (std::string{one.name} + ", recursive").substr(0, 24).c_str());
  std::printf(" %24s%s\n", "smoother, AR(1)", truth ? "     truth    errors [%]" : "");
  std::vector<double> squares(methods.size() + 1, 0.0);
  for (std::size_t j = 0; j < regression.parameters.size(); ++j) {
    std::vector<const NamedValue*> row;
    for (const Method& one : methods) row.push_back(&one.parameters[j]);
    row.push_back(&regression.parameters[j]);
    std::printf("%-10s", row.back()->name.c_str());
    for (const NamedValue* one : row) std::printf(" %12.4f +- %8.4f", one->value, one->std);
    if (truth) {
      const double mean = vehicle.priors[j].mean;
      std::printf("  %8.4f ", mean);
      for (std::size_t i = 0; i < row.size(); ++i) {
        const double off = row[i]->value / mean - 1.0;
        std::printf(" %6.1f", 100.0 * off);
        squares[i] += off * off;
      }
    }
    std::printf("  %s\n", row.back()->unit.c_str());
  }
  if (!truth) return;
  std::printf("parameter error, root mean square:");
  for (const double square : squares)
    std::printf(" %.1f %%", 100.0 * std::sqrt(square / static_cast<double>(regression.parameters.size())));
  std::printf("\n");
}

/// Why nothing could be learnt: said in place of a table that would show the vehicle file's prior.
[[noreturn]] void refuse_prior(const Recording& recording, const Method& method, const std::vector<Thrusters>& inputs,
                               const model::Vehicle& vehicle) {
  const auto valid = std::ranges::count_if(method.runs.front(), &StateEstimate::valid);
  const auto told = std::ranges::count_if(inputs, [&](const Thrusters& one) {
    return one.has_tau || static_cast<Eigen::Index>(one.force.size()) == vehicle.allocation.cols();
  });
  throw InputError(recording.name + ": nothing could be learnt from the states of the " + method.name + ": " +
                   std::to_string(valid) + " of them are valid, and " + std::to_string(told) + " of " +
                   std::to_string(inputs.size()) + " messages of THRUSTERS tell what drove " + vehicle.name +
                   "; what a table would show is the vehicle file's prior");
}

/// Of a recording that does not say who measured: a laboratory's motion capture and a tactical gyro, as on Beluga.
estimation::EstimatorSettings usual_estimator() {
  estimation::EstimatorSettings settings;
  settings.position_noise = 1e-3;     // m
  settings.attitude_noise = 5e-3;     // rad
  settings.depth_noise = 1e-2;        // m
  settings.velocity_noise = 1e-2;     // m/s
  settings.rate_noise = 1e-2;         // rad/s
  settings.bias_walk = 2e-5;          // rad/s in one second
  settings.bias_prior = 2e-3;         // rad/s
  settings.acceleration_walk = 5e-2;  // m/s in one second
  settings.rate_walk = 0.1;           // rad/s in one second
  return settings;
}

/// Of a recording that does not say how it was identified: nothing is forgotten, nothing frozen, and noise in
/// proportion to the vehicle.
identification::IdentifierSettings usual_identifier() {
  identification::IdentifierSettings settings;
  settings.noise_force = 0.1;           // N
  settings.noise_moment = 0.05;         // N m
  settings.noise_acceleration = 0.015;  // m/s^2 of a window's average, as the pipelines have it
  settings.max_skew = 30.0;             // s: recordings are heard one stream after the other
  return settings;
}

void run_methods(const MethodsOptions& options) {
  const model::Vehicle vehicle = model::Vehicle::load(options.vehicle);
  check_command_units(options.map, vehicle);
  std::vector<std::string> notes;
  std::vector<std::string> paths = paths_of(options.train);
  const std::size_t fitted_runs = paths.size();
  std::ranges::move(paths_of(options.validate), std::back_inserter(paths));
  std::vector<Recording> recordings = read_recordings(paths, options.map, notes, vehicle.dof);
  const estimation::TrialFiles files = trial_files(
      {.config = options.config, .vehicle = options.vehicle, .site = options.site}, recordings.front(), notes);
  for (const std::string& note : notes) std::fprintf(stderr, "%s\n", note.c_str());
  const auto identifier_settings =
      files.identifier ? identification::IdentifierSettings::from(*files.identifier) : usual_identifier();
  if (!files.identifier)
    std::fprintf(
        stderr,
        "%s: no section identifier in the log or in --config: recursive estimate with windows of %.0f s, noise "
        "of %.1f cm/s^2\n",
        recordings.front().name.c_str(), identifier_settings.window, 100.0 * identifier_settings.noise_acceleration);
  const std::string filter =
      files.estimator && files.estimator->has("filter") ? files.estimator->text("filter") : "recorded";
  const bool captured = filter == "recorded" && std::ranges::all_of(recordings, [](const Recording& one) {
                          return !one.pose_capture.empty() && !one.ahrs.empty();
                        });

  auto checked = consistency::check_consistency(recordings);
  consistency::check_thrusters(recordings, vehicle, checked);
  std::vector<Method> methods;
  if (captured || (filter == "complementary" &&
                   std::ranges::none_of(recordings, [](const Recording& one) { return one.state.empty(); })))
    methods.push_back({.name = "complementary filter", .errors = {"complementary filter"}});
  const bool own = !methods.empty();
  methods.push_back({.name = "Kalman filter", .errors = {"Kalman filter"}});
  methods.push_back({.name = "Kalman smoother", .errors = {"Kalman smoother"}});
  Method &forward = methods[own ? 1 : 0], &smoothed = methods.back();

  std::vector<identification::BaseRun> runs;
  std::vector<std::vector<Thrusters>> inputs;
  estimation::ProcessNoise process;
  for (std::size_t i = 0; i < fitted_runs; ++i) {
    const Recording recording = estimation::corrected(recordings[i], checked.corrections[i]);
    inputs.push_back(forces(recording, checked.corrections[i], vehicle));
    // Noises are stated by the pipeline: a rest's would not be those of the filter beside it.
    notes.clear();
    auto found = estimation::reconstruct_state(recording, files, {.noises_stated = true}, notes);
    for (const std::string& note : notes) std::fprintf(stderr, "%s\n", note.c_str());
    if (i == 0) process = found.settings.process;
    if (own)
      methods.front().runs.push_back(
          captured ? filtered(recording, files.estimator ? estimation::EstimatorSettings::from(*files.estimator)
                                                         : usual_estimator())
                   : recording.state);
    if (own) compare(methods.front().runs.back(), recording.truth, methods.front().errors);
    compare(found.trial.filtered, recording.truth, forward.errors);
    compare(found.trial.smoothed, recording.truth, smoothed.errors);
    forward.runs.push_back(std::move(found.trial.filtered));
    smoothed.runs.push_back(states_of(found.trial.smoothed));
    runs.push_back({std::move(found.trial.smoothed), inputs.back()});
  }
  for (Method& one : methods) {
    const auto model = recursive(identifier_settings, vehicle, one, inputs);
    if (!model) refuse_prior(recordings.front(), one, inputs.front(), vehicle);
    one.parameters = model->parameters;
  }
  const identification::BaseFit regression = identification::fit_base(vehicle, runs);

  std::printf("process noise by likelihood: jerk %.3g, angular jerk %.3g\n", process.jerk, process.angular_jerk);
  print_parameters(methods, regression, vehicle, options.truth);
  if (smoothed.errors.count > 0.0) {
    std::printf("state error, root mean square: position [m], attitude [rad], velocity [m/s], rates [rad/s], ");
    std::printf("acceleration [m/s^2]\n");
    for (const Method& one : methods) one.errors.print();
  }
  if (options.validate.empty()) return;
  std::vector<Trial> trials;
  for (std::size_t i = fitted_runs; i < recordings.size(); ++i) {
    const Trial run = estimation::reconstruct(recordings[i], checked.corrections[i], vehicle);
    for (Trial& stretch : estimation::known_stretches(run, residual::kHorizons.back()))
      trials.push_back(std::move(stretch));
  }
  if (trials.empty()) {
    throw InputError(options.validate.front() + (options.validate.size() > 1 ? " and its fellows" : "") +
                     estimation::text(": no stretch of %.0f s over which it is known what drove the vehicle; record "
                                      "motion and thrusters together without pauses",
                                      residual::kHorizons.back()));
  }
  std::printf("validation error, m/s and rad/s:\n");
  for (const Method& one : methods)
    validate((std::string{one.name} + ", recursive").c_str(), vehicle, one.parameters, trials);
  validate("smoother, regression under AR(1)", vehicle, regression.parameters, trials);
}

}  // namespace

void add_methods(runtime::CommandLine& app) {
  auto options = std::make_shared<MethodsOptions>();
  runtime::CommandLine* command = app.add_subcommand("methods", "identify recordings by both methods and compare");
  command->add_option("--vehicle", options->vehicle, "vehicle file (YAML)")->required();
  command->add_option("--config", options->config,
                      "pipeline file with sections estimator and identifier; else what the log tells, else the usual");
  command->add_option("--site", options->site, "site file (YAML): tags, transponders, floor; else the log's");
  command->add_option("--train", options->train, "logs or tables to identify from")->required();
  command->add_option("--validate", options->validate, "logs or tables on which predictions are judged");
  command->add_option("--map", options->map, "column map of .csv files");
  command->add_flag("--truth", options->truth, "the vehicle file's means are the truth (simulated logs)");
  command->callback([options] { run_methods(*options); });
}

}  // namespace fathom::tool
