#include "common/diagnosis/round.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>
#include <utility>

#include "common/diagnosis/evidence.hpp"
#include "common/diagnosis/moments.hpp"
#include "common/diagnosis/rivals.hpp"

namespace fathom::diagnosis {
namespace {

using identification::FitResult;
using identification::TrajectoryFit;

constexpr double kAsGood = 0.9;          // of the gain: with fewer numbers, that is the better explanation
constexpr double kHopeless = 1.0 / 3.0;  // of the best gain so far: screening does not err by more
constexpr double kClearlyLess = 0.6;     // of the best gain so far, on a spread of windows
constexpr double kAlike = 0.7;           // correlation of what two candidates change
constexpr double kRestart = 0.1;         // of the screened size: where a fit that went astray begins again
constexpr double kMuch = 0.5;            // of the winner's gain
constexpr double kClearlyMore = 2.0;     // log odds over those needed: so much would show beside noise
constexpr const char* kTrifle = "not evident beside what is too little or too quick to count";
constexpr double kQuickTolerance = 1e-3;  // relative decrease of the cost; a tenth of the smallest gain that counts

/// More gain wins, but hardly more gain with more numbers does not, unless those numbers are evident.
bool better(const Answers& answers, std::size_t place, const FitResult& fit, const Winner& best, double reference,
            double evident) {
  const Screened &own = answers.near[place], &its = answers.near[best.place];
  const int numbers = own.effect->numbers(own.variant), others = its.effect->numbers(its.variant);
  const double gain = reference - fit.cost, other = reference - best.fit.cost;
  if (numbers == others) return gain > other;
  const bool richer = numbers > others;
  const FitResult &fewer = richer ? best.fit : fit, &more = richer ? fit : best.fit;
  const bool worth =
      kAsGood * (reference - more.cost) > reference - fewer.cost ||
      (more.cost < fewer.cost && odds_by_what_is_left(fewer, more, std::abs(numbers - others), 1) > evident);
  return richer ? worth : !worth;
}

/// A model with the effect never explains less than the same model without it; a fit that says so has gone astray, and
/// begins again nearer to absence.
FitResult fit_with(const TrajectoryFit& problem, const FitResult& reference, const model::Model& start,
                   const Screened& screened) {
  FitResult fit = problem.fit(start, &reference, kQuickTolerance);
  if (fit.cost <= reference.cost) return fit;
  model::Model nearer = reference.model;
  nearer.add({screened.effect, screened.variant, screened.variant_name, screened.theta});
  for (model::ActiveEffect& active : nearer.effects) {
    if (active.effect != screened.effect || active.variant != screened.variant) continue;
    const int amplitudes = screened.effect->amplitudes();
    const auto scaled = amplitudes > 0 ? static_cast<std::size_t>(amplitudes) : active.theta.size();
    for (std::size_t i = 0; i < scaled; ++i) active.theta[i] *= kRestart;
  }
  FitResult again = problem.fit(nearer, &reference, kQuickTolerance);
  return again.cost < fit.cost ? again : fit;
}

/// Seconds beside a sudden change no slope leads to it, and a large one is then hardly told from none.
FitResult at_its_moment(const TrajectoryFit& problem, FitResult fit, const Screened& screened) {
  return at_best_moment(problem, std::move(fit), *screened.effect, screened.variant);
}

}  // namespace

Round::Round(Answers& answers, Promises& promises, const TrajectoryFit& problem, const FitResult& reference,
             std::span<const Trial> train, const Settings& settings, int tried, const Progress& progress, double done)
    : answers_{answers},
      promises_{promises},
      problem_{problem},
      reference_{reference},
      train_{train},
      settings_{settings},
      tried_{tried},
      progress_{progress},
      done_{done},
      coarse_{problem, train, settings, reference} {}

std::optional<Winner> Round::fit_best(Which first, std::size_t few, std::size_t most) {
  std::optional<Winner> best;
  for (std::size_t fits = 0; fits < most; ++fits) {
    if (best && fits >= few) break;
    const Which which = first == Which::kAll && fits >= few ? Which::kOpen : first;
    const std::vector<std::size_t> order = worth_fitting(answers_, promises_, settings_, which);
    const double best_share = best ? reduction(reference_.cost, best->fit.cost) : 0.0;
    const auto hopeful = std::ranges::find_if(order, [&](std::size_t i) {
      const double promise = promises_.expected(answers_, i);
      return promise >= kHopeless * best_share ||
             (best && looks_like(i, *best) && promise >= kHopeless * answers_.share[best->place]);
    });
    if (hopeful == order.end()) break;
    const std::size_t next = *hopeful;
    std::optional<FitResult> fit = fit_in_full(next, best_share);
    if (fit && answers_.judged[next].reason.empty() &&
        (!best || better(answers_, next, *fit, *best, reference_.cost, settings_.accept_log_odds)) &&
        counts_beside_memory(next, *fit))
      best = Winner{next, std::move(*fit)};
  }
  if (best && !counts_beside_trifles(*best)) {
    answers_.judged[best->place].reason = kTrifle;
    promises_.refused(answers_, best->place);
    stands_.erase(best->place);
    best.reset();
  }
  return best;
}

/// What was refused for its size alone acts all the same, and others imitate it: a winner must be evident beside what
/// explains much of the same.
bool Round::counts_beside_trifles(const Winner& best) const {
  const auto gain = [&](const FitResult& fit) { return reference_.cost - fit.cost; };
  const FitResult* most = nullptr;
  for (const auto& [place, fit] : trifles_) {
    if (most == nullptr || fit.cost < most->cost) most = &fit;
  }
  if (most == nullptr || gain(*most) < kMuch * gain(best.fit)) return true;
  const Screened& screened = answers_.near[best.place];
  model::Model both = most->model;
  for (const model::ActiveEffect& active : best.fit.model.effects) {
    if (active.effect == screened.effect && active.variant == screened.variant) both.add(active);
  }
  Judged beside = answers_.judged[best.place];
  judge_by_odds(beside, *most, fit_with(problem_, *most, both, screened), tried_);
  return evident(beside, settings_) && beside.error_reduction >= settings_.smallest_reduction;
}

/// A random force with a memory may look like the effect. Where there is one, which explains more, the effect must be
/// evident beside it, unless forces would hardly show it.
bool Round::counts_beside_memory(std::size_t i, const FitResult& fit) {
  if (!random_) random_.emplace(reference_.model, train_);
  const RandomForce::Answer answer = random_->ask(fit.model);
  Judged& judged = answers_.judged[i];
  const auto windows = static_cast<double>(problem_.windows().size());
  const double cost = price(judged.effect->numbers(judged.variant), windows, tried_);
  const double odds = answer.both - answer.memory - cost, needed = needed_log_odds(judged, settings_);
  judged.beside_memory = odds;
  const bool noisy = answer.memory > std::max(answer.effect, needed);
  if (odds >= needed || !noisy || answer.expected - cost < kClearlyMore * needed) return true;
  char text[160];
  std::snprintf(text, sizeof text,
                "a random force with a memory explains as much: log odds %.1f beside one, %.1f needed", odds, needed);
  judged.reason = text;
  promises_.refused(answers_, i);
  stands_.erase(i);
  return false;
}

/// What changes the same motion in the same way is measured by the promise of that, not by what its fit has kept:
/// screening errs alike for both.
bool Round::looks_like(std::size_t place, const Winner& best) const {
  const Screened &one = answers_.near[place], &other = answers_.near[best.place];
  return one.effect != other.effect && one.signature.size() == other.signature.size() &&
         one.signature.dot(other.signature) > kAlike;
}

/// Empty when a spread of windows already tells that it would be in vain, or gain far less than `best_share`.
std::optional<FitResult> Round::fit_in_full(std::size_t i, double best_share) {
  const Screened& screened = answers_.near[i];
  Judged& judged = answers_.judged[i];
  progress_("fitting " + std::string(screened.effect->name()) + " " + screened.variant_name, done_);
  answers_.fitted[i] = true;
  model::Model start;
  if (coarse_.useful() && !answers_.found[i]) {
    const TrajectoryFit& problem = coarse_.problem();
    const FitResult& without = coarse_.reference();
    const FitResult rough =
        at_its_moment(problem, fit_with(problem, without, start_of(problem, without, answers_, i), screened), screened);
    const double share = reduction(without.cost, rough.cost);
    const bool vain = share < kPromise * settings_.smallest_reduction;
    if (vain || share < kClearlyLess * best_share) {
      promises_.kept(answers_, i, share);
      judge_by_odds(judged, without, rough, tried_);
      judged.reason = refusal(judged, settings_);
      if (vain) promises_.refused(answers_, i);
      if (judged.reason.empty()) judged.reason = kWeaker;
      return std::nullopt;
    }
    start = rough.model;
  } else {
    start = start_of(problem_, reference_, answers_, i);
  }
  FitResult fit = at_its_moment(problem_, fit_with(problem_, reference_, start, screened), screened);
  promises_.kept(answers_, i, reduction(reference_.cost, fit.cost));
  judge_by_odds(judged, reference_, fit, tried_);
  judge_by_few_windows(judged, problem_, fit, tried_, settings_);
  judged.reason = refusal(judged, settings_, &fit.model);
  if (judged.reason.empty() || doubtful(judged, settings_)) {
    if (!checked_) checked_.emplace(problem_, reference_);
    judge_by_data_left_out(judged, problem_, reference_, *checked_, fit);
    judged.reason = refusal(judged, settings_, &fit.model);
  }
  if (judged.reason.empty()) {
    stands_.insert_or_assign(i, fit);
  } else {
    promises_.refused(answers_, i);
    if (evident(judged, settings_) && (judged.too_quick || judged.change < settings_.smallest_change))
      trifles_.insert_or_assign(i, fit);
  }
  return fit;
}

void Round::name_rivals(const Winner& winner, const FitResult& near, Judged& accepted) const {
  const BaseNumbers numbers{problem_, reference_};
  find_aliases(accepted, answers_.near[winner.place], answers_, numbers, near.model,
               problem_.windows()[0].window().trial->dt, settings_);
  find_rivals(accepted, winner.fit, stands_, answers_, numbers, problem_, settings_);
}

}  // namespace fathom::diagnosis
