// What a diagnosis costs: each candidate's first look and its full fit on 330 s of a vehicle with four axes at 100 Hz,
// and the whole of it by the trial's length.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "common/diagnosis/diagnoser.hpp"
#include "common/diagnosis/questions.hpp"
#include "common/identification/fit_from_priors.hpp"
#include "common/identification/sparse.hpp"
#include "test/support/virtual_dive.hpp"

using namespace fathom;

namespace {

constexpr double kTrial = 330.0;       // s
constexpr double kSearchStep = 0.04;   // s between the samples that a search looks at
constexpr double kValidation = 100.0;  // s

/// 100 Hz, velocity 5 mm/s, rates 0.2 deg/s.
Trial dive(double duration, unsigned seed) {
  return test::make_dive(test::vehicle_from_repository("seabotix_lbv150"),
                         {.duration = duration, .dt = 0.01, .step = 0.005, .seed = seed, .rate_noise = 0.0035})
      .trial;
}

/// A clean trial with its base model fitted, as a search has it when it asks its first question.
struct Asked {
  model::Vehicle vehicle = test::vehicle_from_repository("seabotix_lbv150");
  diagnosis::Settings settings;
  std::vector<Trial> trials{identification::sparse(dive(kTrial, 1), kSearchStep)};
  model::Scene scene = model::scene_of(vehicle, trials);
  identification::FitResult base = identification::fit_from_priors(vehicle, trials, settings.fit);
  identification::TrajectoryFit problem{vehicle, trials, settings.fit};
  diagnosis::NearView near{vehicle, trials, settings};

  Asked() {
    settings.threads = 1;
    near.fit(base.model);
  }
};

const Asked& asked() {
  static const Asked kAsked;
  return kAsked;
}

std::vector<diagnosis::Candidate> forms_of(const Asked& trial, const model::Effect& effect) {
  std::vector<diagnosis::Candidate> forms = diagnosis::all_candidates(trial.scene);
  std::erase_if(forms, [&](const diagnosis::Candidate& form) { return form.effect != &effect; });
  return forms;
}

/// All forms of one effect, by short windows.
void look(benchmark::State& state, const model::Effect* effect) {
  const Asked& trial = asked();
  const auto forms = forms_of(trial, *effect);
  if (forms.empty()) return state.SkipWithError("has no form that this trial could show");
  for (auto _ : state)
    benchmark::DoNotOptimize(diagnosis::ask_near(forms, trial.near, trial.scene, trial.settings).share.data());
  state.counters["forms"] = static_cast<double>(forms.size());
}

/// The form that promises most, by trajectories, together with the base numbers.
void fit(benchmark::State& state, const model::Effect* effect) {
  const Asked& trial = asked();
  const auto forms = forms_of(trial, *effect);
  if (forms.empty()) return state.SkipWithError("has no form that this trial could show");
  const diagnosis::Answers answers = diagnosis::ask_near(forms, trial.near, trial.scene, trial.settings);
  const auto best = static_cast<std::size_t>(std::ranges::max_element(answers.share) - answers.share.begin());
  const model::Model start = diagnosis::start_of(trial.problem, trial.base, answers, best);
  for (auto _ : state) benchmark::DoNotOptimize(trial.problem.fit(start, &trial.base).cost);
}

void diagnose(benchmark::State& state) {
  const model::Vehicle vehicle = test::vehicle_from_repository("seabotix_lbv150");
  const std::array<Trial, 1> train{dive(static_cast<double>(state.range(0)), 1)}, validate{dive(kValidation, 2)};
  const diagnosis::Settings settings;
  for (auto _ : state) {
    const auto report = diagnosis::diagnose(vehicle, train, validate, settings, [](const std::string&, double) {});
    state.SetLabel(report.result.verdict);
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
