#include "common/diagnosis/search.hpp"

#include <algorithm>
#include <optional>

#include "common/diagnosis/final_fit.hpp"
#include "common/diagnosis/lack_of_form.hpp"
#include "common/diagnosis/moments.hpp"
#include "common/diagnosis/pruning.hpp"
#include "common/diagnosis/questions.hpp"
#include "common/identification/input_hold.hpp"
#include "common/identification/sparse.hpp"

namespace fathom::diagnosis {
namespace {

using identification::FitResult;
using identification::TrajectoryFit;

constexpr std::size_t kRefits = 6;           // candidates per round that earn a full fit
constexpr std::size_t kWholeRefits = 2;      // whatever it promises by whole windows
constexpr std::size_t kMostRefits = 8;       // while no winner is found and the screening still speaks for some
constexpr std::size_t kSearchWindows = 160;  // half an hour; more only makes the search longer
constexpr double kSearchStep = 0.04;         // s: coarser than most recordings, finer than any vehicle moves
constexpr double kAsGood = 0.9;              // of the gain: with fewer numbers, that is the better explanation
constexpr double kHopeless = 1.0 / 3.0;      // of the best gain so far: screening does not err by more
constexpr double kClearlyLess = 0.6;         // of the best gain so far, on a spread of windows
constexpr double kRestart = 0.1;             // of the screened size: where a fit that went astray begins again
constexpr double kQuickTolerance = 1e-3;     // relative decrease of the cost; a tenth of the smallest gain that counts

/// The candidate that gains most and that nothing speaks against.
struct Winner {
  std::size_t place{};
  FitResult fit;
};

/// More gain wins, but hardly more gain with more numbers does not.
bool better(const Answers& answers, std::size_t place, const FitResult& fit, const Winner& best, double reference) {
  const double gain = reference - fit.cost;
  const double other = reference - best.fit.cost;
  const auto numbers = answers.near[place].effect->parameters().size();
  const auto others = answers.near[best.place].effect->parameters().size();
  if (numbers == others) return gain > other;
  return numbers < others ? gain > kAsGood * other : kAsGood * gain > other;
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

/// One round's full fits: the most promising candidates, most promising first.
class Round {
 public:
  Round(Answers& answers, Promises& promises, const TrajectoryFit& problem, const FitResult& reference,
        std::span<const Trial> train, const Settings& settings, int tried, const Progress& progress, double done)
      : answers_{answers},
        promises_{promises},
        problem_{problem},
        reference_{reference},
        settings_{settings},
        tried_{tried},
        progress_{progress},
        done_{done},
        coarse_{problem, train, settings, reference} {}

  /// `first` tells which candidates are meant; after `few` fits without a winner, only open ones, `most` in all.
  std::optional<Winner> fit_best(Which first, std::size_t few, std::size_t most) {
    std::optional<Winner> best;
    for (std::size_t fits = 0; fits < most; ++fits) {
      if (best && fits >= few) break;
      const Which which = first == Which::kAll && fits >= few ? Which::kOpen : first;
      const std::vector<std::size_t> order = worth_fitting(answers_, promises_, settings_, which);
      if (order.empty()) break;
      const std::size_t next = order.front();
      const double best_share = best ? reduction(reference_.cost, best->fit.cost) : 0.0;
      if (promises_.expected(answers_, next) < kHopeless * best_share) break;
      std::optional<FitResult> fit = fit_in_full(next, best_share);
      if (fit && answers_.judged[next].reason.empty() &&
          (!best || better(answers_, next, *fit, *best, reference_.cost)))
        best = Winner{next, std::move(*fit)};
    }
    return best;
  }

  [[nodiscard]] Coarse& coarse() { return coarse_; }

 private:
  /// Empty when a spread of windows already tells that it would be in vain, or gain far less than `best_share`.
  std::optional<FitResult> fit_in_full(std::size_t i, double best_share) {
    const Screened& screened = answers_.near[i];
    Judged& judged = answers_.judged[i];
    progress_("fitting " + std::string(screened.effect->name()) + " " + screened.variant_name, done_);
    answers_.fitted[i] = true;
    model::Model start;
    if (coarse_.useful() && !answers_.found[i]) {
      const TrajectoryFit& problem = coarse_.problem();
      const FitResult& without = coarse_.reference();
      const FitResult rough = at_its_moment(
          problem, fit_with(problem, without, start_of(problem, without, answers_, i), screened), screened);
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
    judged.reason = refusal(judged, settings_, &fit.model);
    if (judged.reason.empty() || doubtful(judged, settings_)) {
      if (!checked_) checked_.emplace(problem_, reference_);
      judge_by_data_left_out(judged, problem_, reference_, *checked_, fit);
      judged.reason = refusal(judged, settings_, &fit.model);
    }
    if (!judged.reason.empty()) promises_.refused(answers_, i);
    return fit;
  }

  Answers& answers_;
  Promises& promises_;
  const TrajectoryFit& problem_;
  const FitResult& reference_;
  const Settings& settings_;
  int tried_;
  const Progress& progress_;
  double done_;
  Coarse coarse_;
  std::optional<CrossValidation> checked_;  // of the reference, made when the first fit is judged
};

/// The final model without the effects that are no longer accepted.
model::Model only_accepted(const SearchResult& result) {
  model::Model model = result.after.model;
  std::erase_if(model.effects, [&](const model::ActiveEffect& active) {
    return std::ranges::none_of(result.accepted, [&](const Judged& judged) {
      return judged.effect == active.effect && judged.variant == active.variant;
    });
  });
  return model;
}

}  // namespace

SearchResult search(const model::Vehicle& vehicle, std::span<const Trial> train, const Settings& settings,
                    const Progress& progress) {
  std::vector<Trial> trials;
  for (const Trial& trial : train) trials.push_back(identification::sparse(trial, kSearchStep));
  SearchResult result;
  progress("fitting the base model", 0.0);
  identification::FitSettings spread = settings.fit;
  spread.most_windows = std::min(spread.most_windows, kSearchWindows);
  result.before = identification::fit_from_priors(vehicle, trials, spread);
  const TrajectoryFit problem{vehicle, trials, spread};
  result.before = identification::with_input_hold(problem, std::move(result.before));
  NearView near{vehicle, trials, settings};
  const model::Scene scene = model::scene_of(vehicle, trials);
  const std::vector<Candidate> candidates = all_candidates(scene);
  const int tried = static_cast<int>(candidates.size());
  result.after = result.before;
  Promises promises;

  for (int round = 0; round < settings.most_effects; ++round) {
    const double done = 0.2 + 0.6 * round / settings.most_effects;
    progress("round " + std::to_string(round + 1) + ": asking " + std::to_string(tried) + " candidates", done);
    near.fit(result.after.model);
    Answers answers = ask_near(candidates, near, scene, settings);
    promises.recall(answers);
    Round fits{answers, promises, problem, result.after, trials, settings, tried, progress, done};
    std::optional<Winner> winner = fits.fit_best(Which::kAll, kRefits, kRefits);
    if (!winner) {
      progress("round " + std::to_string(round + 1) + ": looking at whole windows", done);
      ask_whole(answers, problem, result.after, scene, tried, settings);
      winner = fits.fit_best(Which::kAll, kWholeRefits, kMostRefits);
    }
    if (!winner) {
      look_afar(answers, fits.coarse(), result.after, scene, progress, done);
      winner = fits.fit_best(Which::kFromAfar, kRefits, kRefits);
    }
    if (winner) {
      Judged accepted = answers.judged[winner->place];
      find_aliases(accepted, answers.near[winner->place], answers.near, answers.judged, settings);
      result.accepted.push_back(accepted);
      result.after = problem.fit(winner->fit.model, &winner->fit);
      result.after = at_best_moment(problem, std::move(result.after), *accepted.effect, accepted.variant);
      result.after = identification::with_input_hold(problem, std::move(result.after));
    }
    name_unfitted(answers);
    result.refused = best_of_each_effect(answers.judged, result.accepted);
    if (!winner) break;
  }
  const FitResult searched = result.after;
  progress("final fits", 0.8);
  // The search may have seen a spread of windows at a lower rate; what it found is tested on everything.
  near.fit(result.after.model);
  auto [whole, after] = fit_everything(vehicle, train, settings, near, result.after.model);
  result.window = whole.settings().window;
  result.after = identification::with_input_hold(whole, std::move(after));
  result.before = result.accepted.empty() ? result.after : whole.fit(result.before.model);
  prune(result, whole, settings, tried, progress);
  if (test_forms(result, problem, problem.fit(result.after.model, &searched), scene, progress)) {
    result.after = whole.fit(only_accepted(result), &result.after);
    prune(result, whole, settings, tried, progress);
  }
  if (result.accepted.empty()) result.after = result.before;
  whole.add_covariance(result.before);
  whole.add_covariance(result.after);
  return result;
}

}  // namespace fathom::diagnosis
