#include "common/diagnosis/pruning.hpp"

#include <string>
#include <utility>
#include <vector>

#include "common/diagnosis/evidence.hpp"
#include "common/diagnosis/judgement.hpp"

namespace fathom::diagnosis {
namespace {

using identification::FitResult;
using identification::TrajectoryFit;

constexpr double kMissedBadly = 0.5;      // of the error; a quick fit is off by a few per cent of it at most
constexpr double kQuickTolerance = 1e-3;  // relative decrease of the cost

/// For every accepted effect, the fitted model in which it alone is missing. Each test remembers the last one's, so
/// that fits far from where the effect was begin near their end.
class FitsWithout {
 public:
  FitsWithout(const SearchResult& result, const TrajectoryFit& problem) : problem_{problem} {
    for (const Judged& judged : result.accepted) {
      model::Model model = result.before.model;
      model.effects = result.after.model.effects;
      starts_.push_back(without(std::move(model), judged));
    }
  }

  FitResult fit(const SearchResult& result, std::size_t i) {
    const Judged& judged = result.accepted[i];
    const model::Model plain = without(result.after.model, judged);
    model::Model& start = starts_[i];
    start.input_hold = plain.input_hold;
    if (problem_.cost(plain, result.after) < problem_.cost(start, result.after)) start = plain;
    FitResult fit = problem_.fit(start, &result.after, kQuickTolerance);
    // What is missed so badly is missed by the best fit too.
    if (reduction(fit.cost, result.after.cost) < kMissedBadly) fit = problem_.fit(fit.model, &fit);
    start = fit.model;
    return fit;
  }

  void drop(std::size_t i, const Judged& judged) {
    starts_.erase(starts_.begin() + static_cast<std::ptrdiff_t>(i));
    for (model::Model& start : starts_) start = without(std::move(start), judged);
  }

 private:
  const TrajectoryFit& problem_;
  std::vector<model::Model> starts_;
};

}  // namespace

void prune(SearchResult& result, const TrajectoryFit& problem, const Settings& settings, int tried,
           const Progress& progress) {
  FitsWithout fits{result, problem};
  for (std::size_t i = 0; i < result.accepted.size();) {
    Judged again = result.accepted[i];
    progress("testing " + std::string(again.effect->name()) + " on everything", 0.85);
    const FitResult fit = fits.fit(result, i);
    again.log_odds = log_odds(fit.window_cost, result.after.window_cost, again.effect->numbers(again.variant), tried) -
                     surprise(result.after.model, again);
    again.error_reduction = reduction(fit.cost, result.after.cost);
    judge_by_few_windows(again, problem, result.after, tried, settings);
    const std::string limited = at_limit(again, result.after.model);  // on everything it may have gone where it had not
    if (limited.empty() && evident(again, settings) && again.error_reduction >= settings.smallest_reduction) {
      result.accepted[i] = again;
      ++i;
      continue;
    }
    again.reason = !limited.empty()             ? limited
                   : result.accepted.size() > 1 ? "made superfluous by the other effects"
                                                : refusal(again, settings);
    result.refused.push_back(again);
    result.accepted.erase(result.accepted.begin() + static_cast<std::ptrdiff_t>(i));
    fits.drop(i, again);
    result.after = problem.fit(fit.model, &fit);  // it may have been a quick one
    i = 0;
  }
}

}  // namespace fathom::diagnosis
