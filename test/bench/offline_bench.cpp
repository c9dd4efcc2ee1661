// What a diagnosis does beside its search: reading, checking and reconstructing 330 s at 100 Hz, and writing the page.
#include <benchmark/benchmark.h>

#include <string>

#include "common/consistency/consistency.hpp"
#include "common/estimation/reconstruct.hpp"
#include "common/report/page.hpp"
#include "common/report/report.hpp"
#include "common/tables/csv.hpp"
#include "test/support/diagnosis_fixture.hpp"
#include "test/support/synthetic_recording.hpp"

using namespace fathom;

namespace {

void csv(benchmark::State& state) {
  std::string text = "t,a,b,c,d,e,f,g,h,i\n";
  while (text.size() < 10'000'000) text += "12.345678,-0.001234,1.5e-3,1580.25,0,1,-2.718281828,3.14159,42,0.5\n";
  for (auto _ : state) benchmark::DoNotOptimize(tables::parse_csv(text, "big.csv").rows());
  state.SetBytesProcessed(static_cast<std::int64_t>(state.iterations() * text.size()));
}
BENCHMARK(csv)->Unit(benchmark::kMillisecond);

Recording five_minutes() {
  return test::synthetic_recording(
      {.seed = 30, .duration = 330.0, .pose_rate = 100.0, .gyro_rate = 100.0, .dvl_rate = 100.0});
}

void consistency(benchmark::State& state) {
  const Recording recording = five_minutes();
  for (auto _ : state)
    benchmark::DoNotOptimize(consistency::check_consistency(std::span(&recording, 1)).findings.size());
}
BENCHMARK(consistency)->Unit(benchmark::kMillisecond);

void reconstruct(benchmark::State& state) {
  const Recording recording = five_minutes();
  const auto checked = consistency::check_consistency(std::span(&recording, 1));
  for (auto _ : state)
    benchmark::DoNotOptimize(estimation::reconstruct(recording, checked.corrections[0], model::Vehicle{}).size());
}
BENCHMARK(reconstruct)->Unit(benchmark::kMillisecond);

void page(benchmark::State& state) {
  const auto report = test::made_up_report();
  for (auto _ : state) benchmark::DoNotOptimize(report::to_html(report).size());
}
BENCHMARK(page)->Unit(benchmark::kMillisecond);

}  // namespace
