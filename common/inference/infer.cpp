#include "common/inference/infer.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "common/inference/followed.hpp"
#include "common/model/driven_axes.hpp"
#include "common/model/parameters.hpp"
#include "common/model/rollout.hpp"
#include "common/residual/open_loop.hpp"

namespace fathom::inference {
namespace {

using likelihood::NumberKind;

likelihood::Fit by_horizon(const likelihood::Problem& problem, const likelihood::Fit& fit, int threads) {
  likelihood::Fit reported = likelihood::fit(problem, fit.hypothesis, fit.noise,
                                             {.noise_rounds = 1,
                                              .steps = 3,
                                              .enough = 1.0,
                                              .fit_noise = false,
                                              .horizon = likelihood::Horizon{},
                                              .threads = threads});
  return reported.finite ? reported : fit;
}

/// Share by which the open-loop error on the fitted runs surely falls from `one` to `other`; 0 where chance may have
/// it.
double fall_of_error(const likelihood::Problem& problem, std::span<const Trial> trials, const likelihood::Fit& one,
                     const likelihood::Fit& other) {
  constexpr std::size_t kMostWindows = 100;  // evenly chosen
  constexpr double kSure = 2.0;              // standard errors over windows
  std::vector<model::Window> windows;
  for (const Trial& trial : trials)
    std::ranges::move(residual::windows_within(trial, trial.t.front(), trial.t.back(), {}),
                      std::back_inserter(windows));
  const std::size_t every = windows.size() / kMostWindows + 1;
  for (std::size_t w = 0; w * every < windows.size(); ++w) windows[w] = windows[w * every];
  windows.resize((windows.size() + every - 1) / every);
  residual::Compared compared;
  residual::compare(model_of(one.hypothesis, problem.input_step), model_of(other.hypothesis, problem.input_step),
                    windows, {}, compared);
  const residual::Ratio ratio = ratio_of(compared);
  const bool sure = ratio.windows > 2 && std::log(ratio.value) + kSure * ratio.log_error < 0.0;
  return sure ? 1.0 - ratio.value : 0.0;
}

double length_of(const likelihood::Problem& problem) {
  double length = 0.0;
  for (const likelihood::RunData& run : problem.runs) length += run.last_time() - run.first_time();
  return length;
}

/// What follows from one end of the search.
class Concluding {
 public:
  Concluding(const likelihood::Problem& problem, const model::Scene& scene, std::span<const Trial> trials,
             const Settings& settings, const Progress& progress, const Deadline& deadline)
      : problem_{problem},
        scene_{scene},
        trials_{trials},
        settings_{settings},
        progress_{progress},
        deadline_{deadline} {}

  Conclusion from(Found found) const {
    Conclusion conclusion;
    conclusion.found = std::move(found);
    if (conclusion.found.best.fit.finite) {
      describe(conclusion);
      report(conclusion);
    }
    conclude(problem_, settings_.thresholds, conclusion);
    return conclusion;
  }

 private:
  void describe(Conclusion& conclusion) const {
    const likelihood::Fit& best = conclusion.found.best.fit;
    const Seen seen = see(problem_, best, settings_.threads);
    conclusion.followed = followed(problem_, seen);
    for (std::size_t e = 0; e < best.hypothesis.model.effects.size(); ++e)
      conclusion.modulation.push_back(modulation_of(problem_, seen, scene_, e, settings_.thresholds));
    for (std::size_t axis = 0; axis < static_cast<std::size_t>(problem_.simulated); ++axis) {
      const likelihood::AxisNoise& noise = best.noise[axis];
      const int of = problem_.axes[axis];
      conclusion.random.push_back({of, noise[likelihood::kForce], noise[likelihood::kForceMemory],
                                   noise[likelihood::kForce] / std::max(seen.applied[of], 1e-9)});
    }
    for (const model::ActiveEffect& active : best.hypothesis.model.effects) {
      const model::Unlisted other = active.effect->looks_like(active.theta, active.variant, scene_);
      if (!other.what.empty())
        conclusion.look_alikes.push_back(
            {std::string{active.effect->name()}, std::string{other.what}, std::string{other.told_by}});
    }
  }

  void report(Conclusion& conclusion) const {
    const Found& found = conclusion.found;
    double of_base = 0.0;
    if (!found.best.names.empty()) progress_.expect(kHorizonFit.phase, 2, kHorizonFit.weight);
    conclusion.reported = reported(found.best.fit, conclusion.disagreement);
    conclusion.reported_base = found.best.names.empty() ? conclusion.reported : reported(found.base.fit, of_base);
  }

  likelihood::Fit reported(const likelihood::Fit& fit, double& gain) const {
    progress_.begin(kHorizonFit.phase, kHorizonFit.what);
    likelihood::Fit by = deadline_.over() ? fit : by_horizon(problem_, fit, settings_.threads);
    gain = deadline_.over() ? 0.0 : fall_of_error(problem_, trials_, fit, by);
    progress_.done(kHorizonFit.phase);
    return gain > settings_.thresholds.disagreement ? by : fit;
  }

  const likelihood::Problem& problem_;
  const model::Scene& scene_;
  std::span<const Trial> trials_;
  const Settings& settings_;
  const Progress& progress_;
  const Deadline& deadline_;
};

}  // namespace

void conclude(const likelihood::Problem& problem, const Thresholds& thresholds, Conclusion& conclusion) {
  const Found& found = conclusion.found;
  auto& reasons = conclusion.reasons;
  const double length = length_of(problem);
  if (length < thresholds.shortest) {
    reasons.push_back({Cause::kTooShort, length, thresholds.shortest, ""});
    conclusion.verdict = Verdict::not_judged;
    return;
  }
  if (!found.best.fit.finite) {
    reasons.push_back({Cause::kNotFinite, 0.0, 0.0, ""});
    conclusion.verdict = Verdict::not_judged;
    return;
  }

  const likelihood::Fit& fit = found.best.fit;
  for (std::size_t axis = 0; axis < conclusion.followed.size(); ++axis) {
    const int of = problem.axes[axis];
    const bool skilled = std::ranges::find(conclusion.skilled, of) != conclusion.skilled.end();
    // A boat's sway has no thrust that it could fail to follow.
    if (!model::pushed_along(*problem.vehicle, of)) continue;
    if (conclusion.followed[axis] < thresholds.following && !skilled)
      reasons.push_back({Cause::kNotFollowing, conclusion.followed[axis], thresholds.following,
                         model::kAxisNames[static_cast<std::size_t>(of)]});
  }
  for (const likelihood::Number& number : fit.numbers) {
    if (number.kind != NumberKind::kBase) continue;
    // Of an axis that enters as measured only its part in the Coriolis forces is known: hardly anything.
    const auto parameter = model::parameter_from_name(number.name);
    const auto simulated = std::span{problem.axes}.first(static_cast<std::size_t>(problem.simulated));
    if (parameter && std::ranges::find(simulated, model::axis(*parameter)) == simulated.end()) continue;
    const double size = std::abs(value(fit.hypothesis, number)) / (std::abs(number.mean) + number.sigma);
    const bool pinned = number.low > 0.0 && value(fit.hypothesis, number) <= number.low * (1.0 + 1e-9);
    if (size > thresholds.absurd || pinned)
      reasons.push_back({Cause::kAbsurdNumber, size, thresholds.absurd, number.name});
  }
  if (!reasons.empty()) {
    conclusion.verdict = Verdict::no_model;
    return;
  }

  if (conclusion.disagreement > thresholds.disagreement)
    reasons.push_back({Cause::kScoresDisagree, conclusion.disagreement, thresholds.disagreement, ""});
  bool unexplained = false;
  if (found.free_force && found.free_force->log_odds >= thresholds.free_force_odds &&
      found.free_force->size.share >= thresholds.smallest_size) {
    std::string of;
    for (const GroupFound& group : found.free_force->groups) of += (of.empty() ? "" : "; ") + words(group);
    // Where there was no time to fit it, a first look promises it, and promises of much are no numbers.
    const double odds =
        found.free_force->fit.finite ? found.free_force->log_odds : std::numeric_limits<double>::quiet_NaN();
    reasons.push_back({Cause::kFreeForce, odds, thresholds.free_force_odds, of});
    unexplained = true;
  }
  for (const RandomForce& force : conclusion.random) {
    if (force.memory <= thresholds.slow_memory || force.share <= thresholds.smallest_size) continue;
    reasons.push_back({Cause::kSlowRandomForce, force.memory, thresholds.slow_memory,
                       model::kAxisNames[static_cast<std::size_t>(force.axis)]});
    unexplained = true;
  }
  const auto names = static_cast<int>(claims(found.best.fit.hypothesis.model.effects));
  // Whether many leave nothing is not known of a search that was cut short.
  const bool few = found.wanted > 0 || found.cut_short;
  const int most = few ? thresholds.few_effects : thresholds.most_effects;
  if (found.wanted > 0 || names >= most) {
    reasons.push_back(
        {Cause::kManyNames, static_cast<double>(std::max(names, found.wanted)), static_cast<double>(most), ""});
    unexplained = true;
  }
  if (found.cut_short) reasons.push_back({Cause::kOutOfTime, found.spent, found.given, ""});
  // Odds of names are those of models that are complete; here none is, so none of them is a claim.
  if (unexplained) {
    conclusion.verdict = Verdict::unexplained;
    return;
  }
  if (!found.best.names.empty()) {
    // Of what the craft's flow does by nature neither the terms need be told apart nor, beside a name of what is
    // missing, that they act; how often names of their evidence are right was learned of what is missing.
    const auto& effects = fit.hypothesis.model.effects;
    double least = 1.0, beside_others = 1.0;
    for (std::size_t e = 0; e < found.probability.size(); ++e) {
      const bool own = e < effects.size() && by_nature(effects[e]);
      if (own && (names > 0 || by_nature(found.rival[e]))) continue;
      least = std::min(least, found.probability[e] * (own ? 1.0 : found.reliability[e]));
      beside_others = std::min(beside_others, found.probability[e]);
    }
    const bool sure = least >= thresholds.name_probability;
    const Cause cause = sure                                          ? Cause::kNamed
                        : beside_others < thresholds.name_probability ? Cause::kRivals
                                                                      : Cause::kWeakEvidence;
    reasons.push_back({cause, least, thresholds.name_probability, ""});
    conclusion.verdict = sure && !found.cut_short ? Verdict::effect : Verdict::ambiguous;
    return;
  }
  const double promised = found.refused.empty() ? 0.0 : found.refused.front().promised;
  reasons.push_back({Cause::kNothingFound, promised, thresholds.name_odds, ""});
  conclusion.verdict = found.cut_short ? Verdict::not_judged : Verdict::adequate;
}

Conclusion infer(const model::Vehicle& vehicle, std::span<const Trial> trials, const Settings& settings,
                 const Progress& progress) {
  const likelihood::Problem problem = likelihood::make_problem(vehicle, trials, settings.runs);
  model::Scene scene = model::scene_of(vehicle, trials);
  scene.candidates = settings.candidates;
  if (length_of(problem) < settings.thresholds.shortest) {
    Conclusion conclusion;
    conclude(problem, settings.thresholds, conclusion);
    return conclusion;
  }
  progress.expect(kHorizonFit.phase, 1, kHorizonFit.weight);
  const Deadline deadline{settings.time_budget};
  const Concluding concluding{problem, scene, trials, settings, progress, deadline};
  Conclusion conclusion = concluding.from(
      search(problem, scene, settings.without, settings.thresholds, settings.threads, progress, deadline));
  // Many names imitate what no list holds: with more than a few, a model must leave nothing.
  const bool leaves = conclusion.verdict == Verdict::unexplained || conclusion.verdict == Verdict::no_model;
  if (!leaves || conclusion.found.fewer.empty()) return conclusion;
  Found few = std::move(conclusion.found.fewer.front());
  few.ended_as(conclusion.found);
  if (!few.cut_short) few.wanted = static_cast<int>(claims(conclusion.found.best.fit.hypothesis.model.effects));
  return concluding.from(std::move(few));
}

}  // namespace fathom::inference
