#include "common/diagnosis/reconsidered.hpp"

#include <algorithm>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "common/diagnosis/acting_order.hpp"
#include "common/diagnosis/evidence.hpp"
#include "common/diagnosis/judgement.hpp"
#include "common/diagnosis/moments.hpp"
#include "common/diagnosis/rivals.hpp"

namespace fathom::diagnosis {
namespace {

using identification::FitResult;
using identification::TrajectoryFit;

constexpr double kQuickTolerance = 1e-3;  // relative decrease of the cost

/// The fit with that form in the effect's place, from the numbers of the one that is there or from where a search
/// begins, whichever costs less: beside the others little may be left of what is there.
FitResult fit_in_its_place(const SearchResult& result, const Judged& there, const Judged& form,
                           const TrajectoryFit& problem, const model::Scene& scene) {
  const model::Model rest = without(result.after.model, there);
  std::vector<std::vector<double>> starts = form.effect->starts(scene, form.variant);
  for (const model::ActiveEffect& active : result.after.model.effects) {
    if (active.effect == there.effect && active.variant == there.variant) starts.push_back(active.theta);
  }
  model::Model best;
  double least = std::numeric_limits<double>::infinity();
  for (const std::vector<double>& theta : starts) {
    model::Model model = rest;
    model.add({form.effect, form.variant, form.variant_name, theta, acts_last(result.after.model, there)});
    const double cost = problem.cost(model, result.after);
    if (cost >= least) continue;
    least = cost;
    best = std::move(model);
  }
  if (!(least < std::numeric_limits<double>::infinity())) return result.after;
  return at_best_moment(problem, problem.fit(best, &result.after, kQuickTolerance), *form.effect, form.variant);
}

bool can_take_its_place(const SearchResult& result, const Judged& form) {
  return std::ranges::none_of(result.accepted, [&](const Judged& other) {
    return other.effect == form.effect && other.variant == form.variant;
  });
}

/// Odds at which the one with the lower cost is no longer in doubt.
bool settled(const FitResult& worse, const FitResult& better) {
  return robust_log_likelihood_ratio(worse.window_cost, better.window_cost) >= kAlternativeLogOdds;
}

void reconsider(SearchResult& result, std::size_t place, const TrajectoryFit& problem, const model::Scene& scene) {
  const std::vector<std::string> names = result.accepted[place].effect->variants(scene);
  const std::vector<std::string> others = result.accepted[place].other_forms;
  std::vector<std::string> open;
  for (const std::string& name : others) {
    Judged& there = result.accepted[place];
    Judged form = there;
    form.variant = static_cast<int>(std::ranges::find(names, name) - names.begin());
    form.variant_name = name;
    if (form.variant == static_cast<int>(names.size()) || !can_take_its_place(result, form)) continue;
    FitResult fit = fit_in_its_place(result, there, form, problem, scene);
    const bool costs_less = fit.cost < result.after.cost && at_limit(form, fit.model).empty();
    const bool clear = costs_less ? settled(result.after, fit) : settled(fit, result.after);
    const bool dearer = form.effect->numbers(form.variant) > there.effect->numbers(there.variant);
    const bool better = costs_less && (clear || !dearer);
    if (!clear) open.push_back(better ? there.variant_name : name);
    if (!better) continue;
    there = std::move(form);
    result.after = std::move(fit);
  }
  result.accepted[place].other_forms = std::move(open);
}

}  // namespace

void reconsider_forms(SearchResult& result, const TrajectoryFit& problem, const model::Scene& scene,
                      const Progress& progress, double done) {
  for (std::size_t i = 0; i + 1 < result.accepted.size(); ++i) {
    if (result.accepted[i].other_forms.empty()) continue;
    progress("asking again which form of " + std::string(result.accepted[i].effect->name()) + " it is", done);
    reconsider(result, i, problem, scene);
  }
}

}  // namespace fathom::diagnosis
