#include "common/diagnosis/acting_order.hpp"

#include <algorithm>
#include <string>
#include <utility>

#include "common/diagnosis/evidence.hpp"
#include "common/diagnosis/judgement.hpp"
#include "common/diagnosis/rivals.hpp"

namespace fathom::diagnosis {
namespace {

using identification::FitResult;
using identification::TrajectoryFit;

constexpr double kQuickTolerance = 1e-3;  // relative decrease of the cost

bool is_of(const model::ActiveEffect& active, const Judged& judged) {
  return active.effect == judged.effect && active.variant == judged.variant;
}

bool has_company(const SearchResult& result, const Judged& judged) {
  return std::ranges::any_of(result.accepted, [&](const Judged& other) {
    return other.effect != judged.effect && model::changes_thrust(*other.effect);
  });
}

model::Model at_other_end(model::Model model, const Judged& judged) {
  const auto place = std::ranges::find_if(model.effects, [&](const auto& active) { return is_of(active, judged); });
  if (place == model.effects.end()) return model;
  model::ActiveEffect moved = std::move(*place);
  model.effects.erase(place);
  moved.last = !moved.last;
  model.add(std::move(moved));
  return model;
}

}  // namespace

bool acts_last(const model::Model& model, const Judged& judged) {
  const auto beside = [&](const auto& active) {
    return active.effect != judged.effect && model::changes_thrust(*active.effect);
  };
  return std::ranges::any_of(model.effects, [&](const auto& active) { return is_of(active, judged) && active.last; }) &&
         std::ranges::any_of(model.effects, beside);
}

void reconsider_order(SearchResult& result, const TrajectoryFit& problem, const Progress& progress, double done) {
  for (const Judged& judged : result.accepted) {
    if (!judged.effect->order_matters() || !has_company(result, judged)) continue;
    progress("asking where in the thrust's way " + std::string(judged.effect->name()) + " acts", done);
    FitResult fit = problem.fit(at_other_end(result.after.model, judged), &result.after, kQuickTolerance);
    const double odds = robust_log_likelihood_ratio(result.after.window_cost, fit.window_cost);
    if (fit.cost < result.after.cost && odds >= kAlternativeLogOdds) result.after = std::move(fit);
  }
}

}  // namespace fathom::diagnosis
