// The simulator: one control interval of 20 ms with all instruments, and with the body alone.
#include <benchmark/benchmark.h>

#include <string>

#include "common/base/config.hpp"
#include "common/simulation/simulator.hpp"

using namespace fathom;

namespace {

void interval(benchmark::State& state, const std::string& site, const std::vector<std::string>& hide) {
  const std::string root = FATHOM_SOURCE_DIR "/config/";
  const Config config = Config::load(root + "simulation/seabotix_lbv150.yaml");
  simulation::Simulator simulator{model::Vehicle::load(root + "vehicles/seabotix_lbv150.yaml"),
                                  model::Site::load(root + "sites/" + site + ".yaml"),
                                  config.section("simulator"),
                                  {.hide = hide}};
  Vector6d tau = Vector6d::Zero();
  tau[2] = 1.2;
  std::size_t samples = 0;
  for (auto _ : state) {
    simulator.command({.utime = simulator.now(), .tau = tau, .life = 1.0});
    samples += simulator.step().size();
  }
  state.counters["samples"] = benchmark::Counter(static_cast<double>(samples), benchmark::Counter::kAvgIterations);
  // Virtual seconds per real one.
  state.counters["speed"] = benchmark::Counter(static_cast<double>(simulator.interval()) * 1e-6,
                                               benchmark::Counter::kIsIterationInvariantRate);
}

BENCHMARK_CAPTURE(interval, tank, "tank", {});
BENCHMARK_CAPTURE(interval, deep, "deep", {});
BENCHMARK_CAPTURE(interval, tank_tether, "tank", {"tether_tension"});
BENCHMARK_CAPTURE(interval, tank_sensor_latency, "tank", {"sensor_latency"});

}  // namespace
