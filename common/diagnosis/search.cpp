#include "common/diagnosis/search.hpp"

#include <algorithm>
#include <optional>
#include <utility>

#include "common/diagnosis/acting_order.hpp"
#include "common/diagnosis/final_fit.hpp"
#include "common/diagnosis/lack_of_form.hpp"
#include "common/diagnosis/left_to_explain.hpp"
#include "common/diagnosis/look_afar.hpp"
#include "common/diagnosis/moments.hpp"
#include "common/diagnosis/pruning.hpp"
#include "common/diagnosis/reconsidered.hpp"
#include "common/diagnosis/round.hpp"
#include "common/diagnosis/two_at_once.hpp"
#include "common/identification/fit_from_priors.hpp"
#include "common/identification/input_hold.hpp"
#include "common/identification/profile.hpp"
#include "common/identification/sparse.hpp"

namespace fathom::diagnosis {
namespace {

using identification::FitResult;
using identification::TrajectoryFit;

constexpr std::size_t kRefits = 6;           // candidates per round that earn a full fit
constexpr std::size_t kWholeRefits = 2;      // whatever it promises by whole windows
constexpr std::size_t kMostRefits = 8;       // while no winner is found and the screening still speaks for some
constexpr std::size_t kSearchWindows = 160;  // half an hour; more only makes the search longer
constexpr double kLeftByFar = 0.1;           // of the cost, at least: by what reshapes the whole model
constexpr double kMostExplained = 0.5;       // of the error, explained: what was found is no imitation
constexpr double kSearchStep = 0.04;         // s: coarser than most recordings, finer than any vehicle moves

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

/// Share of the error that the effects have removed, one after the other.
double explained(std::span<const Judged> accepted) {
  double left = 1.0;
  for (const Judged& judged : accepted) left *= 1.0 - judged.error_reduction;
  return 1.0 - left;
}

/// How things stood when an effect was found alone that promised most beside another.
struct First {
  Answers answers;
  std::vector<Pair> pairs;
  FitResult reference;
  std::vector<Judged> accepted;
};

void accept(SearchResult& result, const Two& two, const TrajectoryFit& problem) {
  result.after = problem.reweighted(two.fit);
  for (const Judged& judged : two.judged) {
    result.accepted.push_back(judged);
    result.after = at_best_moment(problem, std::move(result.after), *judged.effect, judged.variant);
  }
  result.after = identification::with_input_hold(problem, std::move(result.after));
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
  std::optional<First> first;  // of two, if it was found alone

  for (int round = 0; round < settings.most_effects; ++round) {
    const double done = 0.2 + 0.6 * round / settings.most_effects;
    progress("round " + std::to_string(round + 1) + ": asking " + std::to_string(tried) + " candidates", done);
    near.fit(result.after.model);
    Answers answers = ask_near(candidates, near, scene, settings);
    promises.recall(answers);
    Round fits{answers, promises, problem, result.after, trials, settings, tried, progress, done};
    std::optional<Winner> winner = fits.fit_best(Which::kAll, kRefits, kMostRefits);
    const auto two_beside = [&](const FitResult& reference, const Answers& asked, std::span<const Pair> pairs,
                                const FitResult& alone) {
      auto two = find_two({candidates, near, problem, reference, trials, scene, settings, tried, progress, done}, asked,
                          pairs, alone);
      if (!two) return false;
      accept(result, *two, problem);
      reconsider_forms(result, problem, scene, progress, done);
      reconsider_order(result, problem, progress, done);
      return true;
    };
    const std::vector<Pair> pairs = worthy_pairs(answers);
    if (winner && will_be_followed(pairs, answers, *winner)) {
      if (!first) first = First{answers, pairs, result.after, result.accepted};
    } else if (two_beside(result.after, answers, pairs, winner ? winner->fit : result.after)) {
      continue;
    }
    const double left = winner ? 1.0 : left_to_explain(problem, result.after);
    if (!winner && first && left > kLeftByFar) {
      // It was not followed: alone, its numbers may have gone where the other cannot.
      const First at = *std::exchange(first, std::nullopt);
      const std::vector<Judged> alone = std::exchange(result.accepted, at.accepted);
      const FitResult fit = result.after;
      if (two_beside(at.reference, at.answers, at.pairs, fit)) continue;
      result.accepted = alone;
    }
    // The least that counts, as a share of the cost, which is the error's square.
    const bool something = left > 2.0 * settings.smallest_reduction;
    if (!winner && something) {
      progress("round " + std::to_string(round + 1) + ": looking at whole windows", done);
      ask_whole(answers, problem, result.after, scene, tried, settings);
      winner = fits.fit_best(Which::kAll, kWholeRefits, kMostRefits);
    }
    if (!winner && something && (left > kLeftByFar || explained(result.accepted) < kMostExplained)) {
      look_afar(answers, problem, trials, settings, result.after, scene, progress, done);
      winner = fits.fit_best(Which::kFromAfar, kRefits, kRefits);
    }
    if (winner) {
      Judged accepted = answers.judged[winner->place];
      fits.name_rivals(*winner, near.reference, accepted);
      result.accepted.push_back(accepted);
      result.after = problem.reweighted(std::move(winner->fit));
      result.after = at_best_moment(problem, std::move(result.after), *accepted.effect, accepted.variant);
      result.after = identification::with_input_hold(problem, std::move(result.after));
      reconsider_forms(result, problem, scene, progress, done);
      reconsider_order(result, problem, progress, done);
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
  prune(result, whole, scene, settings, tried, progress);
  if (test_forms(result, problem, problem.fit(result.after.model, &searched), scene, progress)) {
    result.after = whole.fit(only_accepted(result), &result.after);
    prune(result, whole, scene, settings, tried, progress);
  }
  if (result.accepted.empty()) result.after = result.before;
  progress("intervals of what was found", 0.88);
  whole.add_covariance(result.before);
  whole.add_covariance(result.after);
  identification::add_profiles(whole, result.after);
  progress("the last digits, from places and headings", 0.94);
  if (auto refined = with_poses(vehicle, train, settings, result.window, result.after)) {
    result.after = *std::move(refined);
    if (result.accepted.empty()) result.before = result.after;
  }
  return result;
}

}  // namespace fathom::diagnosis
