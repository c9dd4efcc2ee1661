#include "common/diagnosis/search.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdio>
#include <memory>
#include <optional>
#include <thread>

#include "common/diagnosis/evidence.hpp"
#include "common/diagnosis/held_out.hpp"

namespace fathom::diagnosis {
namespace {

using identification::FitResult;
using identification::TrajectoryFit;

constexpr std::size_t kRefits = 6;           // candidates per round that earn a full fit
constexpr double kAtLimit = 1e-3;            // of the number's prior sigma
constexpr std::size_t kCoarseWindows = 80;   // enough to tell whether a far start leads anywhere
constexpr double kAlternativeLogOdds = 3.0;  // 20 to 1 between two look-alikes settles which it is

struct Candidate {
  const model::Effect* effect;
  int variant;
  std::string name;
};

std::vector<Candidate> all_candidates(const model::Scene& scene) {
  std::vector<Candidate> candidates;
  for (const model::Effect* effect : model::all_effects()) {
    const auto variants = effect->variants(scene);
    for (std::size_t v = 0; v < variants.size(); ++v) {
      if (variants[v] != "-") candidates.push_back({effect, static_cast<int>(v), variants[v]});
    }
  }
  return candidates;
}

bool holds(const model::Model& model, const Candidate& candidate) {
  return std::any_of(model.effects.begin(), model.effects.end(), [&](const model::ActiveEffect& active) {
    return active.effect == candidate.effect && active.variant == candidate.variant;
  });
}

std::vector<Screened> screen_all(const Linearisation& base, const std::vector<Candidate>& candidates,
                                 const model::Scene& scene, int threads) {
  std::vector<Screened> screened(candidates.size());
  std::atomic<std::size_t> next{0};
  const auto work = [&] {
    for (std::size_t i = next++; i < candidates.size(); i = next++) {
      screened[i] = screen(base, *candidates[i].effect, candidates[i].variant, candidates[i].name, scene);
    }
  };
  std::vector<std::thread> pool;
  for (int i = 1; i < threads; ++i) pool.emplace_back(work);
  work();
  for (std::thread& thread : pool) thread.join();
  return screened;
}

double reduction(double cost_without, double cost_with) {
  return cost_without > 0.0 ? 1.0 - std::sqrt(std::max(cost_with, 0.0) / cost_without) : 0.0;
}

double sum(std::span<const double> values) {
  double total = 0.0;
  for (const double value : values) total += value;
  return total;
}

std::string refusal(const Judged& judged, const Settings& settings) {
  char text[160];
  if (judged.error_reduction < settings.smallest_reduction) {
    std::snprintf(text, sizeof text, "explains %.2f %% of the error: changes no prediction",
                  100.0 * judged.error_reduction);
    return text;
  }
  if (judged.change < settings.smallest_change) {
    std::snprintf(text, sizeof text, "moves predictions by %.2f %% of the motion: too little to matter",
                  100.0 * judged.change);
    return text;
  }
  if (judged.log_odds < settings.accept_log_odds) {
    std::snprintf(text, sizeof text, "log odds %.1f, %.1f needed", judged.log_odds, settings.accept_log_odds);
    return text;
  }
  if (judged.held_out_blocks < 0.0) return "does not help on blocks of data left out of its estimate";
  if (judged.held_out_runs < 0.0) return "does not carry over from run to run";
  return "";
}

/// Name of a number of the effect that ended at its physical limit (not at zero, which is absence); empty when none
/// did.
std::string limited_number(const model::Model& model, const Screened& screened) {
  for (const model::ActiveEffect& active : model.effects) {
    if (active.effect != screened.effect || active.variant != screened.variant) continue;
    const auto parameters = active.effect->parameters();
    for (std::size_t i = 0; i < parameters.size(); ++i) {
      for (const double limit : {parameters[i].low, parameters[i].high}) {
        if (limit != 0.0 && std::abs(active.theta[i] - limit) < kAtLimit * parameters[i].sigma)
          return std::string(parameters[i].name);
      }
    }
  }
  return "";
}

Judged judge(const Screened& screened, const Linearisation& base, int tried) {
  Judged judged{.effect = screened.effect, .variant = screened.variant, .variant_name = screened.variant_name};
  const auto parameters = static_cast<int>(screened.effect->parameters().size());
  judged.log_odds = log_odds(base.window_cost(), screened.window_cost, parameters, tried);
  judged.error_reduction = reduction(sum(base.window_cost()), sum(screened.window_cost));
  return judged;
}

/// Full fits on a spread of windows for effects whose small sizes tell nothing about their large ones.
void look_afar(std::vector<Screened>& screened, const model::Vehicle& vehicle, std::span<const Trial> train,
               const FitResult& reference, const model::Scene& scene, const Settings& settings,
               const Progress& progress, double share) {
  std::optional<TrajectoryFit> coarse;
  FitResult like, base;
  for (Screened& candidate : screened) {
    for (const std::vector<double>& start : candidate.effect->far_starts(scene, candidate.variant)) {
      if (!coarse) {
        identification::FitSettings few = settings.fit;
        few.most_windows = kCoarseWindows;
        coarse.emplace(vehicle, train, few);
        like.sigma = reference.sigma;
        for (const auto& window : coarse->windows())
          like.nu0.push_back(window.window().trial->nu[window.window().start]);
        base = coarse->fit(reference.model, &like);
      }
      progress("looking further at " + std::string(candidate.effect->name()), share);
      model::Model model = reference.model;
      model.add({candidate.effect, candidate.variant, candidate.variant_name, start});
      const FitResult far = coarse->fit(model, &like);
      const double gain = (base.cost - far.cost) / base.cost * reference.cost;
      if (gain <= candidate.gain) continue;
      candidate.gain = gain;
      candidate.start = far.model;
    }
  }
}

/// The effect's numbers in units of their prior sigma.
std::vector<double> sizes(const model::Model& model, const Screened& screened) {
  std::vector<double> sizes;
  for (const model::ActiveEffect& active : model.effects) {
    if (active.effect != screened.effect || active.variant != screened.variant) continue;
    for (std::size_t i = 0; i < active.theta.size(); ++i)
      sizes.push_back(active.theta[i] / active.effect->parameters()[i].sigma);
  }
  return sizes;
}

/// The best form of each effect, those that gain most first: screening is linear, so a full fit decides about them.
std::vector<std::size_t> worth_fitting(const std::vector<Screened>& screened, const std::vector<Judged>& judged,
                                       const Settings& settings) {
  std::vector<std::size_t> order;
  for (std::size_t i = 0; i < screened.size(); ++i) {
    if (judged[i].error_reduction < settings.smallest_reduction && !screened[i].start) continue;
    const auto same = std::find_if(order.begin(), order.end(),
                                   [&](std::size_t k) { return screened[k].effect == screened[i].effect; });
    if (same == order.end()) {
      order.push_back(i);
    } else if (screened[i].gain > screened[*same].gain) {
      *same = i;
    }
  }
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return screened[a].gain > screened[b].gain; });
  if (order.size() > kRefits) order.resize(kRefits);
  return order;
}

model::Model with_effect(const FitResult& fit, const Screened& screened) {
  if (screened.start) return *screened.start;
  model::Model model = fit.model;
  model.add({screened.effect, screened.variant, screened.variant_name, screened.theta});
  return model;
}

/// Names the look-alikes of the winner, and which of them the data cannot rule out.
void find_aliases(Judged& winner, const Screened& best, const std::vector<Screened>& screened,
                  const std::vector<Judged>& judged, const Settings& settings) {
  for (std::size_t i = 0; i < screened.size(); ++i) {
    const Screened& other = screened[i];
    const std::string name{other.effect->name()};
    if (other.effect == best.effect || other.signature.size() != best.signature.size()) continue;
    if (other.signature.dot(best.signature) < settings.alias_correlation) continue;
    if (std::find(winner.aliased_with.begin(), winner.aliased_with.end(), name) == winner.aliased_with.end()) {
      winner.aliased_with.push_back(name);
    }
    const double between = robust_log_likelihood_ratio(other.window_cost, best.window_cost);
    if (judged[i].reason.empty() && between < kAlternativeLogOdds &&
        std::find(winner.alternatives.begin(), winner.alternatives.end(), name) == winner.alternatives.end()) {
      winner.alternatives.push_back(name);
    }
  }
}

std::vector<Judged> best_of_each_effect(const std::vector<Judged>& judged, const std::vector<Judged>& accepted) {
  std::vector<Judged> best;
  for (const Judged& candidate : judged) {
    const bool taken =
        std::any_of(accepted.begin(), accepted.end(), [&](const Judged& a) { return a.effect == candidate.effect; });
    if (taken) continue;
    const auto same =
        std::find_if(best.begin(), best.end(), [&](const Judged& b) { return b.effect == candidate.effect; });
    if (same == best.end()) {
      best.push_back(candidate);
    } else if (candidate.log_odds > same->log_odds) {
      *same = candidate;
    }
  }
  std::stable_sort(best.begin(), best.end(), [](const Judged& a, const Judged& b) { return a.log_odds > b.log_odds; });
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
                                 static_cast<int>(candidate.effect->parameters().size()), tried);
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
  const std::vector<Candidate> every = all_candidates(scene);
  const int tried = static_cast<int>(every.size());
  result.after = result.before;

  auto base = std::make_unique<Linearisation>(problem, result.after);
  for (int round = 0; round < settings.most_effects; ++round) {
    progress("round " + std::to_string(round + 1) + ": asking " + std::to_string(tried) + " candidates",
             0.2 + 0.6 * round / settings.most_effects);
    std::vector<Candidate> candidates;
    for (const Candidate& candidate : every) {
      if (!holds(result.after.model, candidate)) candidates.push_back(candidate);
    }
    std::vector<Screened> screened = screen_all(*base, candidates, scene, settings.threads);
    look_afar(screened, vehicle, train, result.after, scene, settings, progress,
              0.2 + 0.6 * (round + 0.2) / settings.most_effects);
    std::vector<Judged> judged;
    for (const Screened& candidate : screened) {
      judged.push_back(judge(candidate, *base, tried));
      judged.back().reason = refusal(judged.back(), settings);
    }

    const FitResult reference = result.after;
    std::size_t winner = judged.size();
    FitResult best;
    for (const std::size_t i : worth_fitting(screened, judged, settings)) {
      progress("fitting " + std::string(screened[i].effect->name()) + " " + screened[i].variant_name,
               0.2 + 0.6 * (round + 0.5) / settings.most_effects);
      FitResult fit = problem.fit(with_effect(reference, screened[i]), &reference);
      const HeldOut carried = held_out(problem, reference, fit, sizes(fit.model, screened[i]));
      Judged& entry = judged[i];
      entry.log_odds = log_odds(reference.window_cost, fit.window_cost,
                                static_cast<int>(screened[i].effect->parameters().size()), tried);
      entry.error_reduction = reduction(reference.cost, fit.cost);
      entry.held_out_blocks = carried.blocks;
      entry.held_out_runs = carried.runs;
      entry.change = carried.change;
      entry.reason = refusal(entry, settings);
      const std::string limited = limited_number(fit.model, screened[i]);
      if (entry.reason.empty() && !limited.empty())
        entry.reason = "fits only with " + limited + " at its physical limit";
      if (entry.reason.empty() && (winner == judged.size() || fit.cost < best.cost)) {
        best = std::move(fit);
        winner = i;
      }
    }
    result.refused = best_of_each_effect(judged, result.accepted);
    if (winner == judged.size()) break;
    Judged accepted = judged[winner];
    find_aliases(accepted, screened[winner], screened, judged, settings);
    result.accepted.push_back(accepted);
    result.after = std::move(best);
    result.refused = best_of_each_effect(judged, result.accepted);
    base = std::make_unique<Linearisation>(problem, result.after);
  }
  prune(result, problem, settings, tried, progress);
  progress("final fits", 0.95);
  if (!result.accepted.empty()) {
    result.after = problem.fit(result.after.model);
  }
  problem.add_covariance(result.before);
  problem.add_covariance(result.after);
  return result;
}

}  // namespace fathom::diagnosis
