// What a diagnosis costs: the score test of each effect beside a fitted base model and the full fit of what it promises
// most, on 330 s of a vehicle with four axes at 100 Hz, and the whole of it by the trial's length.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <array>
#include <string>
#include <vector>

#include "common/verdict/by_likelihood.hpp"
#include "test/support/virtual_dive.hpp"

using namespace fathom;

namespace {

constexpr double kTrial = 330.0;       // s
constexpr double kValidation = 100.0;  // s

/// 100 Hz, velocity 5 mm/s, rates 0.2 deg/s; the same vehicle in every dive.
Trial dive(double duration, unsigned seed) {
  return test::make_dive(
             test::vehicle_from_repository("seabotix_lbv150"),
             {.duration = duration, .dt = 0.01, .step = 0.005, .seed = seed, .rate_noise = 0.0035, .spread = 0.0})
      .trial;
}

/// A clean trial with its base model fitted, as a search has it when it asks its first question.
struct Asked {
  model::Vehicle vehicle = test::vehicle_from_repository("seabotix_lbv150");
  std::vector<Trial> trials{dive(kTrial, 1)};
  model::Scene scene = model::scene_of(vehicle, trials);
  likelihood::Problem problem = likelihood::make_problem(vehicle, trials);
  inference::Seen base = inference::see(
      problem, likelihood::fit(problem, likelihood::nominal_hypothesis(problem), likelihood::prior_noise(problem), {}),
      1);
};

const Asked& asked() {
  static const Asked kAsked;
  return kAsked;
}

std::vector<inference::Law> forms_of(const Asked& trial, const model::Effect& effect) {
  std::vector<inference::Law> laws = inference::catalogue(trial.scene, {});
  std::erase_if(laws, [&](const inference::Law& law) { return law.seed.effect != &effect; });
  return laws;
}

/// All forms of one effect.
void look(benchmark::State& state, const model::Effect* effect) {
  const Asked& trial = asked();
  const auto forms = forms_of(trial, *effect);
  if (forms.empty()) return state.SkipWithError("has no form that this trial could show");
  for (auto _ : state)
    benchmark::DoNotOptimize(inference::scan(trial.problem, trial.base, forms, {}, 1).promises.data());
  state.counters["forms"] = static_cast<double>(forms.size());
}

/// The form that promises most, together with the base numbers and the noise.
void fit(benchmark::State& state, const model::Effect* effect) {
  const Asked& trial = asked();
  const auto forms = forms_of(trial, *effect);
  if (forms.empty()) return state.SkipWithError("has no form that this trial could show");
  const auto promises = inference::scan(trial.problem, trial.base, forms, {}, 1).promises;
  if (promises.empty()) return state.SkipWithError("promises nothing");
  model::ActiveEffect active = forms[promises.front().law].seed;
  active.theta = promises.front().theta;
  likelihood::Hypothesis start = trial.base.fit.hypothesis;
  start.model.add(active);
  for (auto _ : state)
    benchmark::DoNotOptimize(likelihood::fit(trial.problem, start, trial.base.fit.noise, {}).log_evidence);
}

void diagnose(benchmark::State& state) {
  const model::Vehicle vehicle = test::vehicle_from_repository("seabotix_lbv150");
  const std::array<Trial, 1> train{dive(static_cast<double>(state.range(0)), 1)}, validate{dive(kValidation, 2)};
  for (auto _ : state) {
    const verdict::Answer answer = verdict::diagnose(vehicle, train, validate, {}, {});
    state.SetLabel(answer.report.result.verdict);
  }
  state.SetComplexityN(state.range(0));
}
BENCHMARK(diagnose)
    ->Name("diagnosis/whole, s of trial")
    ->Arg(82)
    ->Arg(165)
    ->Arg(330)
    ->Arg(660)
    ->Arg(1320)
    ->Unit(benchmark::kSecond)
    ->UseRealTime()
    ->MeasureProcessCPUTime()
    ->Iterations(1)
    ->Complexity(benchmark::oN);

const bool kRegistered = [] {
  for (const model::Effect* effect : model::all_effects()) {
    const std::string name{effect->name()};
    benchmark::RegisterBenchmark(("diagnosis/look/" + name).c_str(), look, effect)->Unit(benchmark::kMillisecond);
    benchmark::RegisterBenchmark(("diagnosis/fit/" + name).c_str(), fit, effect)->Unit(benchmark::kMillisecond);
  }
  return true;
}();

}  // namespace
