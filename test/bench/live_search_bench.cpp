// The live diagnoser's search of one minute: the whole list of effects, on two threads, as it is made beside a trial.
#include <benchmark/benchmark.h>

#include "common/live/live_diagnoser.hpp"
#include "test/support/virtual_dive.hpp"

using namespace fathom;

namespace {

constexpr Utime kStart = 1'600'000'000'000'000;

void live_search(benchmark::State& state) {
  const model::Vehicle vehicle = model::Vehicle::load(FATHOM_SOURCE_DIR "/config/vehicles/seabotix_lbv150.yaml");
  const Trial trial = test::make_dive(vehicle, {.duration = 60.0, .dt = 0.02, .seed = 14}).trial;
  for (auto _ : state) {
    live::LiveDiagnoser diagnoser{{.first_look = 1e3}, vehicle};  // but for the end's
    for (std::size_t k = 0; k < trial.size(); ++k) {
      const Utime utime = utime_after(kStart, trial.t[k]);
      Thrusters thrusters{.utime = utime};
      thrusters.force.assign(trial.input[k].data(), trial.input[k].data() + trial.input[k].size());
      diagnoser.hear(thrusters);
      benchmark::DoNotOptimize(diagnoser.step(StateEstimate{
          .utime = utime, .p_WB = trial.p_WB[k], .q_WB = trial.q_WB[k], .nu = trial.nu[k], .valid = true}));
    }
    benchmark::DoNotOptimize(diagnoser.finish());
  }
}
BENCHMARK(live_search)->Unit(benchmark::kMillisecond);

}  // namespace
