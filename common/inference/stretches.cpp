#include "common/inference/stretches.hpp"

#include <algorithm>
#include <cmath>

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

}  // namespace fathom::inference
