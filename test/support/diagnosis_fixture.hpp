// A made-up but plausible diagnosis: a vehicle whose thrusters lag and whose water flows, seen by a model that knows
// neither ("before") and by one that knows the lag ("after"). Seeded, so every run of a test sees the same numbers.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "common/samples/diagnosis_result.hpp"

namespace fathom::test {

constexpr double kAbsent = std::numeric_limits<double>::quiet_NaN();

struct FixtureOptions {
  std::array<bool, 6> axes{true, true, true, false, true, true};
  std::size_t samples = 6000;
  bool position = true;
  bool voltage = true;
};

/// One validation run with open-loop predictions over 10 s windows.
inline PredictionTrace made_up_trace(const FixtureOptions& options, const std::string& run, unsigned seed) {
  constexpr double kDt = 0.1;
  constexpr std::size_t kWindow = 100;
  constexpr std::array<double, 6> kMass{17.0, 22.0, 25.0, 0.4, 0.5, 0.6};
  constexpr std::array<double, 6> kDrag{8.0, 14.0, 20.0, 0.3, 0.5, 0.5};
  constexpr std::array<double, 6> kDrive{8.0, 8.0, 7.0, 0.3, 0.3, 0.7};
  constexpr std::array<double, 6> kNoise{0.008, 0.008, 0.006, 0.02, 0.02, 0.015};
  constexpr double kLag = 0.35;
  std::mt19937 random{seed};
  std::normal_distribution<double> normal;
  PredictionTrace trace;
  trace.run = run;
  std::array<double, 6> target{}, felt{}, felt_model{}, nu{}, before{}, after{};
  std::array<double, 3> position{};
  double heading = 0.4;
  for (std::size_t i = 0; i < options.samples; ++i) {
    const double t = kDt * static_cast<double>(i);
    if (i % 25 == 0) {
      for (std::size_t k = 0; k < 6; ++k) target[k] = kDrive[k] * normal(random) * (random() % 3 == 0 ? 1.5 : 0.6);
    }
    std::array<double, 6> left_before{}, left_after{}, measured{};
    const bool restart = i % kWindow == 0;
    for (std::size_t k = 0; k < 6; ++k) {
      const double flow = (k == 0 ? 0.9 : k == 1 ? 0.7 : 0.0) * std::cos(heading + (k == 1 ? 1.5 : 0.0));
      felt[k] += kDt / kLag * (target[k] - felt[k]);
      felt_model[k] += kDt / (0.9 * kLag) * (target[k] - felt_model[k]);
      const double drag = kDrag[k] * nu[k] + 1.5 * kDrag[k] * nu[k] * std::abs(nu[k]);
      nu[k] += kDt / kMass[k] * (felt[k] + flow - drag + 0.2 * kDrive[k] * normal(random));
      measured[k] = nu[k] + kNoise[k] * normal(random);
      if (restart) before[k] = after[k] = measured[k];
      const auto drag_of = [&](double v, double scale) {
        return scale * (kDrag[k] * v + 1.5 * kDrag[k] * v * std::abs(v));
      };
      if (!restart) before[k] += kDt / kMass[k] * (target[k] - drag_of(before[k], 1.25));
      if (!restart) after[k] += kDt / kMass[k] * (felt_model[k] + 0.8 * flow - drag_of(after[k], 1.04));
      left_before[k] = felt[k] + flow - target[k] + 0.25 * drag + 0.1 * kDrive[k] * normal(random);
      left_after[k] = felt[k] - felt_model[k] + 0.2 * flow + 0.04 * drag + 0.1 * kDrive[k] * normal(random);
    }
    heading = std::remainder(heading + kDt * nu[5], 2.0 * std::numbers::pi);
    position[0] += kDt * (nu[0] * std::cos(heading) - nu[1] * std::sin(heading)) - 0.002 * position[0];
    position[1] += kDt * (nu[0] * std::sin(heading) + nu[1] * std::cos(heading)) - 0.002 * position[1];
    position[2] += kDt * nu[2] - 0.005 * (position[2] - 1.0);
    trace.t.push_back(t);
    trace.measured.push_back(measured);
    auto shown_before = before;
    auto shown_after = after;
    for (std::size_t k = 0; k < 6; ++k) {
      if (!options.axes[k]) shown_before[k] = shown_after[k] = left_before[k] = left_after[k] = kAbsent;
    }
    trace.before.push_back(shown_before);
    trace.after.push_back(shown_after);
    trace.residual_before.push_back(left_before);
    trace.residual_after.push_back(left_after);
    trace.position.push_back(options.position ? position : std::array<double, 3>{});
    trace.heading.push_back(heading);
    trace.tau.push_back(target);
    if (options.voltage) trace.voltage.push_back(16.4 - 0.0022 * t - 0.01 * std::abs(felt[0]) + 0.01 * normal(random));
    if (restart) trace.restarts.push_back(i);
  }
  return trace;
}

/// Errors that grow with the horizon; `share` scales them.
inline ModelError made_up_error(const FixtureOptions& options, double share) {
  constexpr std::array<const char*, 6> kForces{"X", "Y", "Z", "K", "M", "N"};
  constexpr std::array<double, 6> kSize{0.05, 0.07, 0.04, 0.09, 0.08, 0.11};
  ModelError error;
  for (std::size_t k = 0; k < 6; ++k) {
    if (options.axes[k]) error.force_rmse[kForces[k]] = 30.0 * share * kSize[k];
  }
  for (const double horizon : {1.0, 5.0, 10.0}) {
    PredictionError p{horizon, {}, {}};
    for (std::size_t k = 0; k < 6; ++k) {
      const double rmse = share * kSize[k] * std::sqrt(horizon / 5.0);
      p.rmse[k] = options.axes[k] ? rmse : kAbsent;
      p.r2[k] = options.axes[k] ? 1.0 - 60.0 * rmse * rmse : kAbsent;
    }
    error.prediction.push_back(p);
  }
  return error;
}

/// A whole report with effects accepted, refused and aliased, sensor faults, and validation traces.
inline DiagnosisReport made_up_report(const FixtureOptions& options = {}) {
  DiagnosisReport report;
  DiagnosisResult& r = report.result;
  r.vehicle = "Beluga <test>";
  r.train = {"random-1", "surge-1", "sway-1", "heave-1", "yaw-1"};
  r.validate = {"random-2"};
  r.verdict = "effect";
  r.paragraph =
      "The thrusters answer about 0.35 s late, and the water flows slowly past the vehicle. With both in the model the "
      "prediction 5 s ahead is off by 47 % less on a run that the fit never saw (95 %: 36 to 55 %). The lag is "
      "certain; "
      "the current is likely, but a constant tether pull would look much the same in four of the five runs.\n"
      "What remains in sway still remembers itself for 0.8 s.";
  r.manoeuvre =
      "Turn slowly through 360° on the spot at constant depth, twice, with the tether slack: a current turns with the "
      "heading, a tether does not.";
  r.consistency = {{"random-1", "gyro.r", "pose_capture", "delay", 0.112, "s",
                    "Cross-correlation peaks at 0.112 s (0.98).", "corrected"},
                   {"surge-1", "gyro.r", "pose_capture", "delay", 0.094, "s",
                    "Cross-correlation peaks at 0.094 s (0.97).", "corrected"},
                   {"yaw-1", "gyro.r", "pose_capture", "delay", 0.105, "s",
                    "Cross-correlation peaks at 0.105 s (0.99).", "corrected"},
                   {"all", "dvl.u", "pose_capture", "scale", 0.943, "",
                    "Regression over 3120 samples: 0.943 ± 0.006, R² 0.97.", "trusted pose_capture"},
                   {"heave-1", "pose_capture", "itself", "gap", 14.2, "s",
                    "Pose frozen for 14.2 s between t = 88 s and t = 131 s.", "left out"},
                   {"all", "gyro.p", "pose_capture", "sign", -1.0, "",
                    "Slope -0.99 ± 0.01 against the derivative of attitude.", "corrected"}};
  r.effects = {{"thruster_lag",
                "",
                true,
                {{"time_constant", 0.352, 0.012, "s"}},
                214.6,
                0.92,
                {},
                "The thrusters reach a new force only after about 0.35 s."},
               {"current",
                "",
                true,
                {{"V_N", 0.081, 0.009, "m/s"}, {"V_E", -0.034, 0.011, "m/s"}},
                18.2,
                0.75,
                {{"tether_tension", 1.1}},
                "The water moves at 0.09 m/s towards the north-west."}};
  r.candidates = {{"thruster_lag", "", 214.6, "explains the late answer in every axis"},
                  {"current", "", 18.2, "residual turns with the heading"},
                  {"tether_tension", "", 15.9, "second to current; pulls towards one point"},
                  {"thruster_delay", "", 2.1, "nothing left for it once the lag is in"},
                  {"cross_coupling", "Y_r", 1.2, "gain on validation not above chance"},
                  {"thruster_gain", "thruster 3", -0.4, "gain 0.99 ± 0.02: as the table says"},
                  {"battery_sag", "", -2.8, "voltage hardly moved, 15.1 to 16.4 V"},
                  {"asymmetric_drag", "X_u", -3.1, "ratio 1.02 ± 0.05 includes one"},
                  {"thrust_asymmetry", "", -3.6, "forward and reverse agree"},
                  {"thruster_deadband", "", kAbsent, "commands never stay near neutral: not tested"}};
  r.error_before = made_up_error(options, 1.0);
  r.error_after = made_up_error(options, 0.53);
  r.improvement = {0.47, 0.36, 0.55};
  r.parameters_before = {{"m_X", 21.4, 1.1, "kg"},
                         {"m_Y", 27.0, 1.4, "kg"},
                         {"X_u", -10.2, 0.6, "N/(m/s)"},
                         {"X_u|u|", -19.5, 2.1, "N/(m/s)^2"},
                         {"N_r", -0.61, 0.05, "N m/(rad/s)"},
                         {"W-B", -1.3, kAbsent, "N"}};
  r.parameters_after = {{"m_X", 17.3, 0.4, "kg"},
                        {"m_Y", 22.4, 0.5, "kg"},
                        {"X_u", -8.2, 0.3, "N/(m/s)"},
                        {"X_u|u|", -12.4, 1.1, "N/(m/s)^2"},
                        {"N_r", -0.52, 0.02, "N m/(rad/s)"},
                        {"W-B", -1.2, 0.1, "N"}};
  constexpr std::array<const char*, 6> kForces{"X", "Y", "Z", "K", "M", "N"};
  for (std::size_t k = 0; k < 6; ++k) {
    if (!options.axes[k]) continue;
    r.residual_before.push_back({kForces[k], 1e-12, 1.6, 0.81});
    r.residual_after.push_back({kForces[k], k == 1 ? 0.003 : 0.21, k == 1 ? 0.8 : 0.2, 0.94});
  }
  report.traces.push_back(made_up_trace(options, "random-2", 7));
  return report;
}

}  // namespace fathom::test
