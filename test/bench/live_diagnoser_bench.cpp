// The live diagnoser: one state of Beluga's six axes with its thrusters, all candidates of three minutes considered.
#include <benchmark/benchmark.h>

#include "common/diagnosis/live_diagnoser.hpp"
#include "test/support/virtual_dive.hpp"

using namespace fathom;

namespace {

constexpr Utime kStart = 1'600'000'000'000'000;

void live_diagnoser(benchmark::State& state) {
  const model::Vehicle vehicle = model::Vehicle::load(FATHOM_SOURCE_DIR "/config/vehicles/beluga.yaml");
  const Trial trial = test::make_dive(vehicle, {.duration = 180.0, .seed = 14}).trial;
  std::size_t forms = 0;
  for (auto _ : state) {
    diagnosis::LiveDiagnoser diagnoser{diagnosis::LiveSettings{}, vehicle};
    for (std::size_t k = 0; k < trial.size(); ++k) {
      const Utime utime = utime_after(kStart, trial.t[k]);
      Thrusters thrusters{.utime = utime};
      thrusters.force.assign(trial.input[k].data(), trial.input[k].data() + trial.input[k].size());
      benchmark::DoNotOptimize(diagnoser.step(thrusters));
      benchmark::DoNotOptimize(diagnoser.step(StateEstimate{
          .utime = utime, .p_WB = trial.p_WB[k], .q_WB = trial.q_WB[k], .nu = trial.nu[k], .valid = true}));
    }
    benchmark::DoNotOptimize(diagnoser.finish());
    forms = diagnoser.forms().size();
  }
  state.counters["candidates"] = static_cast<double>(forms);
  state.counters["per state"] = benchmark::Counter(
      static_cast<double>(trial.size()), benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}
BENCHMARK(live_diagnoser)->Unit(benchmark::kMillisecond);

}  // namespace
