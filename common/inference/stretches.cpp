#include "common/inference/stretches.hpp"

#include <algorithm>
#include <cmath>

#include "common/inference/searching.hpp"
#include "common/samples/trial_part.hpp"

namespace fathom::inference {
namespace {

constexpr double kLongEnough = 2.0;      // times the blocks of a search: what is shorter is searched whole
constexpr double kLeastOfBurnIn = 40.0;  // blocks of a stretch are at least so many times those that are not scored

std::size_t blocks_of(const likelihood::Problem& problem) {
  std::size_t count = 0;
  for (const likelihood::RunData& run : problem.runs) count += run.blocks().size();
  return count;
}

}  // namespace

std::optional<Stretches> stretches_of(const likelihood::Problem& whole, const Thresholds& thresholds) {
  const auto all = static_cast<double>(blocks_of(whole));
  if (all <= kLongEnough * thresholds.search_blocks) return std::nullopt;
  const double share = thresholds.search_blocks / all;
  Stretches stretches{.of_whole = 1.0 / share};
  for (std::size_t r = 0; r < whole.runs.size(); ++r) {
    const likelihood::RunData& run = whole.runs[r];
    const Trial& trial = run.trial();
    const double wanted = share * static_cast<double>(trial.size());
    const double burn_in = whole.run_settings.burn_in / trial.dt;
    const double count = std::max(1.0, std::floor(wanted / (kLeastOfBurnIn * burn_in)));
    const double length = wanted / count, cell = static_cast<double>(trial.size()) / count;
    for (int k = 0; k < static_cast<int>(count); ++k) {
      const auto from = static_cast<std::size_t>(k * cell + 0.5 * (cell - length));
      const std::size_t to = std::min(trial.size(), from + static_cast<std::size_t>(length));
      stretches.trials.push_back(part_of(trial, from, to, trial.name));
      stretches.run.push_back(r);
    }
  }
  return stretches;
}

Start on_whole_runs(const likelihood::Fit& of_stretches, const Stretches& stretches, std::size_t runs) {
  Start start{of_stretches.hypothesis, of_stretches.noise};
  start.hypothesis.runs.assign(runs, {});
  std::vector<double> count(runs, 0.0);
  for (const std::size_t run : stretches.run) count[run] += 1.0;
  for (std::size_t s = 0; s < stretches.run.size() && s < of_stretches.hypothesis.runs.size(); ++s) {
    const std::size_t run = stretches.run[s];
    likelihood::RunNumbers& mean = start.hypothesis.runs[run];
    const likelihood::RunNumbers& of = of_stretches.hypothesis.runs[s];
    mean.command_offset += of.command_offset / count[run];
    mean.world_force += of.world_force / count[run];
    mean.velocity_bias += of.velocity_bias / count[run];
  }
  return start;
}

void Searching::know(const Searching& ahead) {
  sought_ = true;
  noted_ = ahead.noted_;
  failed_ = ahead.failed_;
  gave_way_ = ahead.gave_way_;
  in_place_ = ahead.in_place_;
}

void Searching::take_up(const std::vector<Start>& sets) {
  const std::vector<Fitted> fits = models_.race(sets, {.from = found_.base.score});
  const auto best = std::ranges::max_element(fits, {}, &Fitted::score);
  if (best == fits.end() || !best->fit.finite || best->score < found_.best.score + thresholds_.name_odds) return;
  if (best->names.size() < 2 && !counts(*best)) return;
  unnamed_ -= best->score - found_.best.score;
  found_.best = *best;
  drop();
}

Found search(const likelihood::Problem& problem, const model::Scene& scene, const std::vector<std::string>& without,
             const Thresholds& thresholds, int threads, const Progress& progress, const Deadline& deadline) {
  const auto searching = [&](const likelihood::Problem& of, const Progress& told) {
    return Searching{of, scene, without, thresholds, threads, told, deadline};
  };
  const std::optional<Stretches> stretches = stretches_of(problem, thresholds);
  if (!stretches) return searching(problem, progress).run();
  // The same steps on longer runs: other steps, since each takes longer.
  const Progress on_whole = progress.part("whole runs: ", stretches->of_whole);
  Searching::announce(on_whole);
  const likelihood::Problem few = likelihood::make_problem(*problem.vehicle, stretches->trials, problem.run_settings);
  Searching ahead = searching(few, progress);
  const Found found = ahead.run();
  Searching whole = searching(problem, on_whole);
  Before before;
  if (found.base.fit.finite) {
    const auto start = [&](const Fitted& fitted) { return on_whole_runs(fitted.fit, *stretches, problem.runs.size()); };
    before.base = start(found.base);
    const auto take = [&](const Fitted& fitted) {
      const auto names = static_cast<int>(claims(fitted.fit.hypothesis.model.effects));
      if (!fitted.names.empty()) (names > thresholds.few_effects ? before.more : before.sets).push_back(start(fitted));
    };
    const auto take_all = [&](const Found& of) {
      take(of.best);
      std::ranges::for_each(of.near, take);
    };
    std::ranges::for_each(found.fewer, take_all);
    take_all(found);
    whole.know(ahead);
  }
  return whole.run(found.base.fit.finite ? &before : nullptr);
}

}  // namespace fathom::inference
