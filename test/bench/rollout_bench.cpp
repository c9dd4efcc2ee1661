// What everything else is made of: one 10 s window of a six-axis vehicle, simulated, and simulated with derivatives.
#include <benchmark/benchmark.h>

#include <cmath>

#include "common/model/rollout.hpp"

using namespace fathom;

namespace {

struct Bench {
  model::Vehicle vehicle = model::Vehicle::load(FATHOM_SOURCE_DIR "/config/vehicles/beluga.yaml");
  Trial trial;

  Bench() {
    constexpr std::size_t kSamples = 101;
    trial.dt = 0.1;
    trial.observed = {true, true, true, true};
    for (std::size_t k = 0; k < kSamples; ++k) {
      trial.t.push_back(0.1 * static_cast<double>(k));
      trial.p_WB.emplace_back(Eigen::Vector3d::Zero());
      trial.q_WB.emplace_back(Eigen::Quaterniond::Identity());
      trial.nu.emplace_back(Vector6d::Zero());
      Eigen::VectorXd force(static_cast<Eigen::Index>(vehicle.thrusters.size()));
      for (Eigen::Index i = 0; i < force.size(); ++i)
        force[i] = 5.0 * std::sin(0.3 * static_cast<double>(k) + static_cast<double>(i));
      trial.input.push_back(force);
    }
  }
  [[nodiscard]] model::Window window() const { return {&trial, 0, trial.size()}; }
};

model::Model with(const Bench& bench, const char* effect, const std::vector<double>& theta) {
  model::Model model = model::nominal_model(bench.vehicle, false);
  if (effect != nullptr) model.add({model::find_effect(effect), 0, "", theta});
  return model;
}

void rollout(benchmark::State& state, const char* effect, const std::vector<double>& theta) {
  const Bench bench;
  const model::Model model = with(bench, effect, theta);
  model::VelocityTrace trace;
  for (auto _ : state) {
    benchmark::DoNotOptimize(model::rollout(model, bench.window(), Vector6d::Zero(), trace));
  }
}

void derivatives(benchmark::State& state, const char* effect, const std::vector<double>& theta) {
  const Bench bench;
  const model::Model model = with(bench, effect, theta);
  model::VelocityTrace trace;
  model::VelocityDerivatives columns;
  for (auto _ : state) {
    benchmark::DoNotOptimize(model::rollout_with_derivatives(model, bench.window(), Vector6d::Zero(), trace, columns));
  }
}

BENCHMARK_CAPTURE(rollout, base, nullptr, {});
BENCHMARK_CAPTURE(rollout, thruster_gain, "thruster_gain", {0.2});
BENCHMARK_CAPTURE(rollout, current, "current", {0.1, 0.1});
BENCHMARK_CAPTURE(derivatives, base, nullptr, {});
BENCHMARK_CAPTURE(derivatives, thruster_gain, "thruster_gain", {0.2});
BENCHMARK_CAPTURE(derivatives, asymmetric_drag, "asymmetric_drag", {1.0});
BENCHMARK_CAPTURE(derivatives, current, "current", {0.1, 0.1});

}  // namespace
