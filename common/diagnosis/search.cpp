#include "common/diagnosis/search.hpp"

#include <algorithm>
#include <optional>

#include "common/diagnosis/evidence.hpp"
#include "common/diagnosis/questions.hpp"

namespace fathom::diagnosis {
namespace {

using identification::FitResult;
using identification::TrajectoryFit;

constexpr std::size_t kRefits = 6;         // candidates per round that earn a full fit
constexpr std::size_t kManyWindows = 120;  // full fits are dear from here: those that screening finds hopeless are left
constexpr double kHopelessOdds = -5.0;     // log odds by the screening
constexpr double kAsGood = 0.9;            // of the gain: with fewer numbers, that is the better explanation
constexpr double kHopeless = 1.0 / 3.0;    // of the best gain so far: screening does not err by more
constexpr double kQuickTolerance = 1e-3;   // relative decrease of the cost; a tenth of the smallest gain that counts

/// The candidate that gains most and that nothing speaks against.
struct Winner {
  std::size_t place{};
  FitResult fit;
};

/// More gain wins, but hardly more gain with more numbers does not.
bool better(const Answers& answers, std::size_t place, const FitResult& fit, const Winner& best, double reference) {
  const double gain = reference - fit.cost;
  const double other = reference - best.fit.cost;
  const auto numbers = answers.screened[place].effect->parameters().size();
  const auto others = answers.screened[best.place].effect->parameters().size();
  if (numbers == others) return gain > other;
  return numbers < others ? gain > kAsGood * other : kAsGood * gain > other;
}

/// Fits the most promising candidates in full, and fills in what the fits say of them. `only_far`: those that have been
/// found from afar since.
std::optional<Winner> fit_best(Answers& answers, const TrajectoryFit& problem, const FitResult& reference,
                               const Settings& settings, int tried, const Progress& progress, double share,
                               bool only_far = false) {
  std::optional<Winner> best;
  std::size_t fitted = 0;
  std::optional<CrossValidation> checked;
  for (const std::size_t i : worth_fitting(answers, settings)) {
    const Screened& screened = answers.screened[i];
    if (answers.fitted[i] || (only_far && !screened.start)) continue;
    const bool dear = problem.windows().size() > kManyWindows && !screened.start;
    if (dear && answers.judged[i].log_odds < kHopelessOdds) continue;
    if (fitted++ >= kRefits) break;
    answers.fitted[i] = true;
    if (best && screened.gain < kHopeless * (reference.cost - best->fit.cost)) break;  // may come back next round
    progress("fitting " + std::string(screened.effect->name()) + " " + screened.variant_name, share);
    FitResult fit = problem.fit(start_of(reference, screened), &reference, kQuickTolerance);
    Judged& judged = answers.judged[i];
    if (!checked) checked.emplace(problem, reference);
    judge_by_fit(judged, problem, reference, *checked, fit, tried);
    judged.reason = refusal(judged, settings, &fit.model);
    if (judged.reason.empty() && (!best || better(answers, i, fit, *best, reference.cost)))
      best = Winner{i, std::move(fit)};
  }
  return best;
}

/// Drops every accepted effect that the others have made superfluous; fills in the final odds of those that stay.
void prune(SearchResult& result, const TrajectoryFit& problem, const Settings& settings, int tried,
           const Progress& progress) {
  for (std::size_t i = 0; result.accepted.size() > 1 && i < result.accepted.size();) {
    const Judged& candidate = result.accepted[i];
    progress("testing " + std::string(candidate.effect->name()) + " in the company of the others", 0.85);
    model::Model without = result.after.model;
    std::erase_if(without.effects,
                  [&](const auto& a) { return a.effect == candidate.effect && a.variant == candidate.variant; });
    const FitResult fit = problem.fit(without, &result.after);
    const double odds = log_odds(fit.window_cost, result.after.window_cost,
                                 static_cast<int>(candidate.effect->parameters().size()), tried) -
                        surprise(result.after.model, candidate);
    const double share = reduction(fit.cost, result.after.cost);
    if (odds >= settings.accept_log_odds && share >= settings.smallest_reduction) {
      result.accepted[i].log_odds = odds;
      result.accepted[i].error_reduction = share;
      ++i;
      continue;
    }
    Judged dropped = candidate;
    dropped.log_odds = odds;
    dropped.error_reduction = share;
    dropped.reason = "made superfluous by the other effects";
    result.refused.push_back(dropped);
    result.accepted.erase(result.accepted.begin() + static_cast<std::ptrdiff_t>(i));
    result.after = fit;
    i = 0;
  }
}

}  // namespace

SearchResult search(const model::Vehicle& vehicle, std::span<const Trial> train, const Settings& settings,
                    const Progress& progress) {
  SearchResult result;
  progress("fitting the base model", 0.0);
  result.before = identification::fit_from_priors(vehicle, train, settings.fit);
  const TrajectoryFit problem{vehicle, train, settings.fit};
  const model::Scene scene = model::scene_of(vehicle, train);
  const std::vector<Candidate> candidates = all_candidates(scene);
  const int tried = static_cast<int>(candidates.size());
  result.after = result.before;

  for (int round = 0; round < settings.most_effects; ++round) {
    const double share = 0.2 + 0.6 * round / settings.most_effects;
    progress("round " + std::to_string(round + 1) + ": asking " + std::to_string(tried) + " candidates", share);
    Answers answers = ask(candidates, problem, result.after, scene, settings);
    std::optional<Winner> winner = fit_best(answers, problem, result.after, settings, tried, progress, share);
    if (!winner) {
      look_afar(answers, problem, result.after, train, scene, settings, progress, share);
      winner = fit_best(answers, problem, result.after, settings, tried, progress, share, true);
    }
    if (winner) {
      Judged accepted = answers.judged[winner->place];
      find_aliases(accepted, answers.screened[winner->place], answers.screened, answers.judged, settings);
      result.accepted.push_back(accepted);
      result.after = problem.fit(winner->fit.model, &winner->fit);
    }
    result.refused = best_of_each_effect(answers.judged, result.accepted);
    if (!winner) break;
  }
  prune(result, problem, settings, tried, progress);
  progress("final fits", 0.95);
  if (!result.accepted.empty()) result.after = problem.fit(result.after.model);
  problem.add_covariance(result.before);
  problem.add_covariance(result.after);
  return result;
}

}  // namespace fathom::diagnosis
