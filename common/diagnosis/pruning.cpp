#include "common/diagnosis/pruning.hpp"

#include <algorithm>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "common/diagnosis/acting_order.hpp"
#include "common/diagnosis/evidence.hpp"
#include "common/diagnosis/judgement.hpp"
#include "common/identification/input_hold.hpp"

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
  FitsWithout(const SearchResult& result, const TrajectoryFit& problem) : problem_{&problem} {
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
    if (problem_->cost(plain, result.after) < problem_->cost(start, result.after)) start = plain;
    FitResult fit = problem_->fit(start, &result.after, kQuickTolerance);
    // What is missed so badly is missed by the best fit too.
    if (reduction(fit.cost, result.after.cost) < kMissedBadly) fit = problem_->fit(fit.model, &fit);
    start = fit.model;
    return fit;
  }

  void drop(std::size_t i, const Judged& judged) {
    starts_.erase(starts_.begin() + static_cast<std::ptrdiff_t>(i));
    for (model::Model& start : starts_) start = without(std::move(start), judged);
  }

 private:
  const TrajectoryFit* problem_;
  std::vector<model::Model> starts_;
};

/// Another form of one of the accepted effects, fitted without effect `i`: two effects that each look like half of one
/// law have been taken for it (a lag of second order looks like a delay and a lag).
struct OtherForm {
  std::size_t place{};  ///< in accepted
  Judged judged;
  FitResult fit;
};

bool is_accepted(const SearchResult& result, const model::Effect* effect, int variant) {
  return std::ranges::any_of(
      result.accepted, [&](const Judged& judged) { return judged.effect == effect && judged.variant == variant; });
}

/// The start from which the form costs least.
std::optional<model::Model> best_start(const model::Model& rest, const Judged& form, bool last, const FitResult& like,
                                       const TrajectoryFit& problem, const model::Scene& scene) {
  std::optional<model::Model> best;
  double least = 0.0;
  for (const std::vector<double>& theta : form.effect->starts(scene, form.variant)) {
    model::Model model = rest;
    model.add({form.effect, form.variant, form.variant_name, theta, last});
    const double cost = problem.cost(model, like);
    if (best && cost >= least) continue;
    best = std::move(model);
    least = cost;
  }
  return best;
}

/// Of the forms that are not at a limit, the one that costs least.
std::optional<OtherForm> best_other_form(const SearchResult& result, std::size_t i, const FitResult& without_it,
                                         const TrajectoryFit& problem, const model::Scene& scene) {
  std::optional<OtherForm> best;
  for (std::size_t j = 0; j < result.accepted.size(); ++j) {
    const Judged& other = result.accepted[j];
    if (j == i || other.effect->variants_matter()) continue;
    const model::Model rest = without(without_it.model, other);
    const bool last = acts_last(without_it.model, other);
    const std::vector<std::string> names = other.effect->variants(scene);
    for (std::size_t v = 0; v < names.size(); ++v) {
      Judged form = other;
      form.variant = static_cast<int>(v);
      form.variant_name = names[v];
      form.other_forms.clear();
      if (names[v] == "-" || is_accepted(result, form.effect, form.variant)) continue;
      const std::optional<model::Model> start = best_start(rest, form, last, without_it, problem, scene);
      if (!start) continue;
      FitResult fit = problem.fit(*start, &without_it, kQuickTolerance);
      if ((best && best->fit.cost <= fit.cost) || !at_limit(form, fit.model).empty()) continue;
      best = OtherForm{j, std::move(form), std::move(fit)};
    }
  }
  // How commands are held was settled beside the effect that is in question, and may have suited it; but what is itself
  // a time after the command must not be lost to a hold.
  const bool itself_a_time = std::ranges::any_of(result.accepted[i].effect->parameters(),
                                                 [](const auto& number) { return number.after_command; });
  if (best && !itself_a_time) best->fit = identification::with_input_hold(problem, std::move(best->fit));
  return best;
}

/// Whether the data still asks for the effect when the other has that form.
bool needed_beside(const Judged& effect, const OtherForm& other, const SearchResult& result, const Settings& settings,
                   int tried) {
  const Judged& before = result.accepted[other.place];
  const int numbers = effect.effect->numbers(effect.variant) + before.effect->numbers(before.variant) -
                      other.judged.effect->numbers(other.judged.variant);
  Judged again = effect;
  again.log_odds =
      log_odds(other.fit.window_cost, result.after.window_cost, numbers, tried) - surprise(result.after.model, effect);
  again.error_reduction = reduction(other.fit.cost, result.after.cost);
  return evident(again, settings) && again.error_reduction >= settings.smallest_reduction;
}

}  // namespace

void prune(SearchResult& result, const TrajectoryFit& problem, const model::Scene& scene, const Settings& settings,
           int tried, const Progress& progress) {
  FitsWithout fits{result, problem};
  for (std::size_t i = 0; i < result.accepted.size();) {
    Judged again = result.accepted[i];
    progress("testing " + std::string(again.effect->name()) + " on everything", 0.85);
    const FitResult fit = fits.fit(result, i);
    again.log_odds = log_odds(fit.window_cost, result.after.window_cost, again.effect->numbers(again.variant), tried) -
                     surprise(result.after.model, again);
    again.error_reduction = reduction(fit.cost, result.after.cost);
    judge_by_few_windows(again, problem, result.after, tried, settings);
    // On everything it may have gone where it had not.
    const std::string limited =
        too_quick(problem, result.after.model, again) ? kTooQuick : at_limit(again, result.after.model);
    if (limited.empty() && evident(again, settings) && again.error_reduction >= settings.smallest_reduction) {
      if (auto other = best_other_form(result, i, fit, problem, scene);
          other && !needed_beside(again, *other, result, settings, tried)) {
        again.reason = "made superfluous by another form of " + std::string(other->judged.effect->name());
        result.refused.push_back(again);
        result.accepted[other->place] = other->judged;
        result.accepted.erase(result.accepted.begin() + static_cast<std::ptrdiff_t>(i));
        result.after = problem.fit(other->fit.model, &other->fit);
        fits = FitsWithout{result, problem};
        i = 0;
        continue;
      }
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
