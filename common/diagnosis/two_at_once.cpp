#include "common/diagnosis/two_at_once.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "common/diagnosis/evidence.hpp"
#include "common/diagnosis/moments.hpp"
#include "common/model/effect_size.hpp"

namespace fathom::diagnosis {
namespace {

using identification::FitResult;

constexpr std::size_t kPairs = 3;  // that earn a full fit
constexpr std::size_t kFits = 6;   // of what may stand in one's place, itself among them
constexpr double kWorthIt = 0.05;  // of the error: what promises less together is left to be found alone
constexpr double kMore = 1.05;     // times the promise of any alone
constexpr double kFarLess = 0.6;   // of the error along some axis: what leaves more of it is found alone, if at all
constexpr double kQuickTolerance = 1e-3;  // relative decrease of the cost

/// `times`: the amplitudes that it has by itself, within its limits.
model::ActiveEffect scaled(const Screened& screened, double times, const model::Vehicle& vehicle) {
  model::ActiveEffect active{screened.effect, screened.variant, screened.variant_name, screened.theta};
  for (int i = 0; i < screened.effect->amplitudes(); ++i) {
    const auto k = static_cast<std::size_t>(i);
    const model::EffectParameter number = model::parameter_of(*screened.effect, screened.variant, k, vehicle);
    active.theta[k] = std::clamp(times * active.theta[k], number.low, number.high);
  }
  return active;
}

/// Short windows first: what two effects are to each other bends long ones too far.
FitResult fit_both(const TwoAtOnce& with, const Answers& answers, const Pair& pair) {
  model::Model start = with.reference.model;
  start.add(scaled(answers.near[pair.first], pair.of_first, with.problem.vehicle()));
  start.add(scaled(answers.near[pair.second], pair.of_second, with.problem.vehicle()));
  const FitResult short_windows = with.near.problem.fit(start, nullptr, kQuickTolerance);
  FitResult fit = with.problem.fit(short_windows.model, &with.reference, kQuickTolerance);
  for (const std::size_t place : {pair.first, pair.second})
    fit = at_best_moment(with.problem, std::move(fit), *answers.near[place].effect, answers.near[place].variant);
  return fit;
}

/// Odds for both against neither, all pairs that there are being tried.
double odds_together(const TwoAtOnce& with, const FitResult& fit, const Judged& one, const Judged& other) {
  const int numbers = one.effect->numbers(one.variant) + other.effect->numbers(other.variant);
  const int tried = with.tried * with.tried / 2;
  return std::max(log_odds(with.reference.window_cost, fit.window_cost, numbers, tried),
                  odds_by_what_is_left(with.reference, fit, numbers, tried)) -
         surprise(fit.model, one) - surprise(fit.model, other);
}

/// The least share (RMS) that is left of the error along an axis.
double least_left(const FitResult& before, const FitResult& after) {
  double least = 1.0;
  if (before.window_square.size() != after.window_square.size()) return least;
  for (std::size_t axis = 0; axis < 6; ++axis) {
    double was = 0.0, is = 0.0;
    for (std::size_t w = 0; w < after.window_square.size(); ++w) {
      was += before.window_square[w][axis];
      is += after.window_square[w][axis];
    }
    if (was > 0.0) least = std::min(least, std::sqrt(is / was));
  }
  return least;
}

/// `form`: Screened or Judged.
template <class Form>
bool same(const Form& form, const model::Effect* effect, int variant) {
  return form.effect == effect && (form.variant == variant || !effect->variants_matter());
}

bool holds(const Pair& pair, const Answers& answers, const Screened& found) {
  return same(answers.near[pair.first], found.effect, found.variant) ||
         same(answers.near[pair.second], found.effect, found.variant);
}

Judged judged_of(const Screened& screened) {
  return {.effect = screened.effect, .variant = screened.variant, .variant_name = screened.variant_name};
}

/// What stands best in the place of `of`, the other being there: itself, or something else.
std::optional<Winner> judge_beside_other(const TwoAtOnce& with, const FitResult& both, const Judged& of,
                                         Judged& accepted) {
  const FitResult other = with.problem.fit(without(both.model, of), &both, kQuickTolerance);
  with.near.fit(other.model);
  Answers answers = ask_near(with.candidates, with.near, with.scene, with.settings);
  const auto itself = std::ranges::find_if(answers.near, [&](const Screened& screened) {
    return screened.effect == of.effect && screened.variant == of.variant;
  });
  if (itself == answers.near.end()) return {};
  const auto place = static_cast<std::size_t>(itself - answers.near.begin());
  answers.found[place] = both.model;
  Promises promises;
  Round round{answers, promises, with.problem, other, with.trials, with.settings, with.tried, with.progress, with.done};
  std::optional<Winner> winner = round.fit_best(Which::kAll, kFits, kFits);
  if (!winner) return {};
  accepted = answers.judged[winner->place];
  round.name_rivals(*winner, with.near.reference, accepted);
  return winner;
}

std::optional<Two> judge_both(const TwoAtOnce& with, const FitResult& fit, const Judged& one, const Judged& other) {
  Two two;
  const std::optional<Winner> first = judge_beside_other(with, fit, one, two.judged[0]);
  if (!first) return {};
  std::optional<Winner> second = judge_beside_other(with, first->fit, other, two.judged[1]);
  if (!second || same(two.judged[0], two.judged[1].effect, two.judged[1].variant)) return {};
  two.fit = std::move(second->fit);
  return two;
}

}  // namespace

std::vector<Pair> worthy_pairs(const Answers& answers) {
  const double promised = answers.share.empty() ? 0.0 : std::ranges::max(answers.share);
  std::vector<Pair> pairs = promising_pairs(answers, kPairs);
  std::erase_if(pairs, [&](const Pair& pair) {
    return pair.share < std::max(kWorthIt, kMore * promised) || pair.least_left > kFarLess;
  });
  return pairs;
}

bool will_be_followed(std::span<const Pair> worthy, const Answers& answers, const Winner& alone) {
  return !worthy.empty() && holds(worthy.front(), answers, answers.near[alone.place]);
}

std::optional<Two> find_two(const TwoAtOnce& with, const Answers& answers, std::span<const Pair> worthy,
                            const FitResult& alone) {
  struct Fitted {
    Pair pair;
    FitResult fit;
  };
  std::vector<Fitted> fitted;
  for (const Pair& pair : worthy) {
    const Screened &one = answers.near[pair.first], &other = answers.near[pair.second];
    with.progress("fitting " + std::string(one.effect->name()) + " and " + std::string(other.effect->name()),
                  with.done);
    FitResult fit = fit_both(with, answers, pair);
    if (least_left(alone, fit) > kFarLess) continue;
    if (odds_together(with, fit, judged_of(one), judged_of(other)) < with.settings.accept_log_odds) continue;
    fitted.push_back({pair, std::move(fit)});
  }
  if (fitted.empty()) return {};
  Fitted& best = *std::ranges::min_element(fitted, {}, [](const Fitted& one) { return one.fit.cost; });
  best.fit = with.problem.reweighted(std::move(best.fit));  // beside what neither explains each would hardly count
  const FitResult asked = with.near.reference;
  std::optional<Two> two =
      judge_both(with, best.fit, judged_of(answers.near[best.pair.first]), judged_of(answers.near[best.pair.second]));
  with.near.reference = asked;
  return two;
}

}  // namespace fathom::diagnosis
