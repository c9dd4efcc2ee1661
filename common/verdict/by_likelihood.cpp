#include "common/verdict/by_likelihood.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "common/identification/sparse.hpp"
#include "common/learning/left_out.hpp"
#include "common/learning/spread.hpp"
#include "common/learning/steps.hpp"
#include "common/learning/wording.hpp"
#include "common/likelihood/between_runs.hpp"
#include "common/preflight/applicability.hpp"
#include "common/residual/force_residual.hpp"
#include "common/residual/prediction.hpp"
#include "common/residual/traces.hpp"
#include "common/residual/unseen_event.hpp"
#include "common/residual/whiteness.hpp"
#include "common/verdict/covariance.hpp"
#include "common/verdict/followed_axes.hpp"
#include "common/verdict/next_motion.hpp"
#include "common/verdict/skill.hpp"
#include "common/verdict/why_no_model.hpp"

namespace fathom::verdict {
namespace {

using inference::Conclusion;
using inference::Verdict;
using likelihood::NumberKind;

constexpr double kNotAsked = std::numeric_limits<double>::quiet_NaN();  // null in result.json
constexpr double kStep = 0.04;  // s between the velocities that are predicted: short of it there is only noise

std::vector<std::string> names_of(std::span<const Trial> trials) {
  std::vector<std::string> names;
  for (std::size_t r = 0; r < trials.size(); ++r) {
    if (r == 0 || !same_run(trials[r - 1], trials[r])) names.push_back(trials[r].name);
  }
  return names;
}

/// `sigma`: of the numbers.
std::vector<NamedValue> numbers_of(const likelihood::Fit& fit, const Eigen::VectorXd& sigma,
                                   const std::set<int>& withheld) {
  std::vector<NamedValue> values;
  if (!fit.finite || sigma.size() != static_cast<Eigen::Index>(fit.numbers.size())) return values;
  for (std::size_t j = 0; j < fit.numbers.size(); ++j) {
    if (fit.numbers[j].kind == NumberKind::kWeight) continue;
    const auto base = model::parameter_from_name(fit.numbers[j].name);
    if (base && withheld.contains(model::axis(*base))) continue;
    values.push_back({fit.numbers[j].name, value(fit.hypothesis, fit.numbers[j]), sigma[static_cast<Eigen::Index>(j)],
                      fit.numbers[j].unit});
  }
  return values;
}

/// Whether all that judges are stretches of the runs that were fitted.
bool judged_here(std::span<const Trial> train, std::span<const Trial> validate) {
  return !validate.empty() && std::ranges::all_of(validate, [&](const Trial& judging) {
    return std::ranges::any_of(train, [&](const Trial& fitted) { return same_run(judging, fitted); });
  });
}

/// The learned force for runs that judge: whole on stretches of the runs that it was learned from, else what lasts.
const model::LearnedForce* force_for(const learning::Learned& learned, std::span<const Trial> train,
                                     std::span<const Trial> validate) {
  if (validate.empty() || judged_here(train, validate)) return learned.here.get();
  const bool later = std::ranges::all_of(
      validate, [&](const Trial& judging) { return judging.size() > 0 && judging.t.front() >= learned.until; });
  return later ? learned.later.get() : learned.elsewhere.get();
}

/// Share by which the open-loop error on runs that judge is larger by `after` than by `before`; below 0: smaller.
double raises_error(const model::Vehicle& vehicle, const model::Model& before, const model::Model& after,
                    std::span<const Trial> unseen) {
  const std::vector<model::Window> windows = residual::prediction_windows(unseen, residual::lead_of(after));
  if (windows.empty()) return 0.0;
  return -residual::improvement(residual::predict(before, windows), residual::predict(after, windows), vehicle).value;
}

/// Where the reported numbers are not the likelihood's own, what they differ by is an error of the model that no noise
/// tells of: it enters their deviations.
Eigen::VectorXd with_difference(const likelihood::Fit& of, const likelihood::Fit& reported, Eigen::VectorXd sigma) {
  if (sigma.size() != static_cast<Eigen::Index>(of.numbers.size()) || reported.numbers.size() != of.numbers.size())
    return sigma;
  return (sigma.array().square() +
          (values(reported.hypothesis, reported.numbers) - values(of.hypothesis, of.numbers)).array().square())
      .sqrt();
}

/// A name claims a cause only where nothing that no list holds stands beside it: with such a thing in the data every
/// listed law that resembles a part of it has enormous odds, and none means anything (docs/decisions/194).
bool names_claim(Verdict verdict) { return verdict == Verdict::effect || verdict == Verdict::ambiguous; }

/// Numbers of the effect of that place in the model.
std::vector<NamedValue> numbers_of_effect(const likelihood::Fit& fit, std::size_t effect,
                                          const Eigen::VectorXd& sigma) {
  std::vector<NamedValue> values;
  for (std::size_t j = 0; j < fit.numbers.size(); ++j) {
    const likelihood::Number& number = fit.numbers[j];
    if (number.kind != NumberKind::kEffect || number.index != static_cast<int>(effect)) continue;
    values.push_back({number.name.substr(number.name.find('.') + 1), value(fit.hypothesis, number),
                      sigma[static_cast<Eigen::Index>(j)], number.unit});
  }
  return values;
}

/// Effects of `fit`, which gives all other numbers too. `in_model`: of stand-ins.
void list_effects(const Conclusion& conclusion, const likelihood::Fit& fit, const Eigen::VectorXd& sigma, bool in_model,
                  DiagnosisResult& result) {
  const inference::Found& found = conclusion.found;
  const auto& effects = fit.hypothesis.model.effects;
  for (std::size_t e = 0; e < effects.size() && e < found.odds.size(); ++e) {
    const std::string name{effects[e].effect->name()}, &form = effects[e].variant_name;
    if (!names_claim(conclusion.verdict)) {
      result.stand_ins.push_back({name, form, in_model, found.size[e], numbers_of_effect(fit, e, sigma)});
      result.candidates.push_back({name, form, found.odds[e], "stand-in"});
      continue;
    }
    EffectFound effect{.name = name,
                       .variant = form,
                       .parameters = numbers_of_effect(fit, e, sigma),
                       .log_odds = found.odds[e],
                       .probability = found.probability[e] * found.reliability[e],
                       .sentence = std::string(effects[e].effect->sentence())};
    if (!found.rival[e].empty() && found.probability[e] < inference::Thresholds{}.name_probability)
      effect.alternatives.push_back(
          {.name = found.rival[e],
           .log_odds = std::log(found.probability[e] / std::max(1.0 - found.probability[e], 1e-300))});
    result.candidates.push_back({name, form, effect.log_odds, "accepted"});
    result.effects.push_back(std::move(effect));
  }
}

/// The first named effect that another may stand in the place of, and that other as it was fitted there.
std::optional<std::pair<model::ActiveEffect, model::ActiveEffect>> rivals_in(const Conclusion& conclusion,
                                                                             const likelihood::Fit& named) {
  const inference::Found& found = conclusion.found;
  const auto& effects = named.hypothesis.model.effects;
  for (std::size_t e = 0; e < effects.size() && e < found.rival.size(); ++e) {
    if (found.rival[e].empty() || found.probability[e] >= inference::Thresholds{}.name_probability) continue;
    for (const inference::Fitted& near : found.near) {
      for (const model::ActiveEffect& other : near.fit.hypothesis.model.effects) {
        if (other.effect->name() == found.rival[e]) return std::pair{effects[e], other};
      }
    }
  }
  return {};
}

void list_refused(const inference::Found& found, DiagnosisResult& result, VerdictGiven& given) {
  for (const inference::Refused& refused : found.refused) {
    CandidateTried candidate{.name = refused.name, .variant = refused.form, .log_odds = kNotAsked};
    for (const inference::Refusal& refusal : refused.refusals) {
      given.refusals[refused.name].push_back({std::string(word(refusal.rule)), refusal.value, refusal.needed});
      if (refusal.rule == inference::Rule::kOdds && std::isfinite(refusal.value)) candidate.log_odds = refusal.value;
      candidate.reason += (candidate.reason.empty() ? "" : "; ") + sentence(refusal);
    }
    result.candidates.push_back(std::move(candidate));
  }
}

constexpr double kEvident = 0.1;  // of the error: what falls by so much needs no interval, where none can be given

/// Surely, or where too few windows tell how sure that is, by much.
bool helps(const Interval& gain) { return gain.low > 0.0 || (std::isinf(gain.low) && gain.value > kEvident); }

/// Effects that have no form in these runs, with the reason.
void list_not_asked(const model::Scene& scene, DiagnosisResult& result) {
  const std::vector<inference::Law> laws = inference::catalogue(scene, {});
  for (const model::Effect* effect : model::all_effects()) {
    const std::string name{effect->name()};
    if (std::ranges::find(laws, name, &inference::Law::name) != laws.end()) continue;
    result.candidates.push_back(
        {.name = name, .log_odds = kNotAsked, .reason = preflight::why_not_asked(*effect, scene)});
  }
}

/// By how much the error falls with the names on runs that no fit has seen.
Interval held_back(const model::Vehicle& vehicle, std::span<const Trial> unseen, double input_step,
                   const Conclusion& conclusion) {
  const model::Model before = likelihood::model_of(conclusion.reported_base.hypothesis, input_step);
  const model::Model after = likelihood::model_of(conclusion.reported.hypothesis, input_step);
  const std::vector<model::Window> windows = residual::prediction_windows(unseen, residual::lead_of(after));
  if (windows.empty()) return {kNotAsked, kNotAsked, kNotAsked};
  return residual::improvement(residual::predict(before, windows), residual::predict(after, windows), vehicle);
}

/// Something that no fit can have seen, in runs that judge. The fitted ones are seen by the same steps of time.
std::optional<UnseenEvent> something_begins(const model::Model& model, std::span<const Trial> train,
                                            std::span<const Trial> unseen) {
  std::vector<Trial> fitted;
  for (const Trial& trial : train) fitted.push_back(identification::sparse(trial, kStep));
  return residual::unseen_event(model, fitted, unseen);
}

/// Predictions on runs that no fit has seen, beside the simplest ones. An axis that is foretold worse than by saying
/// that nothing changes has no model.
void judge_predictions(const model::Vehicle& vehicle, const model::Model& before, const model::Model& after,
                       std::span<const Trial> unseen, std::span<const Trial> train, DiagnosisReport& report,
                       VerdictGiven& given, Conclusion& conclusion) {
  DiagnosisResult& result = report.result;
  const auto residual_before = residual::wrench_residuals(before, unseen),
             residual_after = residual::wrench_residuals(after, unseen);
  result.error_before.force_rmse = residual::force_rmse(vehicle, residual_before);
  result.error_after.force_rmse = residual::force_rmse(vehicle, residual_after);
  result.residual_before = residual::whiteness(before, unseen, residual_before);
  result.residual_after = residual::whiteness(after, unseen, residual_after);
  report.traces = residual::traces_of(unseen, before, after, residual_before, residual_after);
  const auto& free = conclusion.found.free_force;
  for (std::size_t i = 0; free && i < free->explainable.size() && i < conclusion.random.size(); ++i)
    given.explainable.push_back(
        {model::kAxisNames[static_cast<std::size_t>(conclusion.random[i].axis)], free->explainable[i]});
  report.unseen_event = something_begins(after, train, unseen);
  const std::vector<model::Window> windows = residual::prediction_windows(unseen, residual::lead_of(after));
  if (windows.empty()) return;
  const residual::Predictions by_before = residual::predict(before, windows),
                              by_after = residual::predict(after, windows);
  result.error_before.prediction = by_before.summary(vehicle);
  result.error_after.prediction = by_after.summary(vehicle);
  result.improvement = residual::improvement(by_before, by_after, vehicle);
  const residual::Predictions unchanged = predict_unchanged(windows);
  given.skill = skill_of(vehicle, by_after, unchanged, predict_plainly(vehicle, plain_fit(vehicle, train), windows));
  for (const SkillGiven& row : given.skill) {
    const auto axis =
        static_cast<std::size_t>(std::ranges::find(model::kAxisNames, row.axis) - model::kAxisNames.begin());
    const double p = p_no_worse(by_after, unchanged, kFiveSeconds, axis);
    if (row.horizon_s != residual::kHorizons[kFiveSeconds] || p >= inference::Thresholds{}.no_skill) continue;
    conclusion.reasons.push_back({inference::Cause::kNoSkill, row.over_unchanged, 0.0, row.axis});
    conclusion.verdict = Verdict::no_model;
  }
}

/// What the learned force leaves open on runs that judge.
void tell_of_spread(const likelihood::Problem& problem, const learning::Learned& learned,
                    const model::LearnedForce& force, double input_step, std::span<const Trial> unseen,
                    CorrectionGiven& given) {
  const learning::Telling tell = [&](const model::FreeForce& all) {
    if (&force == learned.here.get()) return all;
    return &force == learned.elsewhere.get() ? model::lasting_of(all) : learning::standing_of(problem, all);
  };
  const model::Model model = learning::as_model(learned.fit.hypothesis, input_step, &force);
  const std::vector<model::Window> windows = residual::prediction_windows(unseen, residual::lead_of(model));
  const Vector6d sigma = learning::spread_of(learned.fit, force.visited(), tell, input_step, windows);
  std::copy(sigma.begin(), sigma.end(), given.prediction_std.begin());
  given.not_visited = learning::not_visited(force, unseen);
  given.words += learning::spread_sentence(given);
}

/// Surge, sway and heave as they are scored.
double scored_velocities(const likelihood::Problem& problem) {
  double count = 0.0;
  for (const likelihood::RunData& run : problem.runs) {
    for (const likelihood::Block& block : run.blocks()) {
      for (int i = 0; i < problem.simulated && block.scored; ++i) {
        const int axis = problem.axes[static_cast<std::size_t>(i)];
        count += axis < 3 && block.n[axis] > 0.0 ? 1.0 : 0.0;
      }
    }
  }
  return count;
}

/// What begins where no fit could see it is something that nothing here explains.
void begins_later(const DiagnosisReport& report, Conclusion& conclusion) {
  if (!report.unseen_event || conclusion.verdict == Verdict::no_model) return;
  conclusion.reasons.push_back(
      {inference::Cause::kBeginsUnseen, report.unseen_event->t, 0.0, report.unseen_event->run});
  if (conclusion.verdict == Verdict::adequate) conclusion.verdict = Verdict::unexplained;
}

}  // namespace

Answer diagnose(const model::Vehicle& vehicle, std::span<const Trial> train, std::span<const Trial> validate,
                const inference::Settings& of_caller, const Progress& progress, const learning::Settings& learning) {
  Answer answer;
  inference::Settings settings = of_caller;
  answer.candidates = model::candidates_of(vehicle, train);
  settings.candidates = answer.candidates.pointers();
  DiagnosisReport& report = answer.report;
  DiagnosisResult& result = report.result;
  answer.given.core = "likelihood";
  result.vehicle = vehicle.name;
  result.train = names_of(train);
  result.validate = names_of(validate);
  result.improvement = {kNotAsked, kNotAsked, kNotAsked};
  if (learning.learn) learning::announce(progress, learning.limits, learning.leaving);
  Conclusion conclusion = inference::infer(vehicle, train, settings, progress);
  std::vector<Trial> unseen;
  double input_step = 0.0;
  for (const Trial& trial : validate) {
    unseen.push_back(identification::sparse(trial, kStep));
    input_step = std::max(input_step, trial.input_step);
  }
  const likelihood::Problem problem = likelihood::make_problem(vehicle, train, settings.runs);
  if (conclusion.verdict == Verdict::no_model && conclusion.reported.finite) {
    conclusion.skilled = skilled_axes(vehicle, train, unseen, input_step, conclusion);
    conclusion.reasons.clear();
    conclude(problem, settings.thresholds, conclusion);
  }
  const bool wiring_sought = conclusion.verdict == Verdict::unexplained || conclusion.verdict == Verdict::no_model;
  if (wiring_sought) seek_wiring(vehicle, train, result, conclusion);
  Interval gain{kNotAsked, kNotAsked, kNotAsked};
  if (conclusion.reported.finite && !conclusion.found.best.names.empty() && !names_claim(conclusion.verdict))
    gain = held_back(vehicle, unseen, input_step, conclusion);
  learning::Learned learned;
  // A model that does not follow its thrust may be opposed by a force that nothing lists; an exchanged thruster is
  // none.
  const bool opposed = conclusion.verdict == Verdict::no_model && conclusion.reported.finite && !result.wiring;
  if (learning.learn && (conclusion.verdict == Verdict::unexplained || opposed)) {
    learned =
        learning::learn(problem, train, conclusion, learning, judged_here(train, validate), settings.threads, progress);
    result.correction = learned.given;
  }
  learning::call_off(progress);
  const model::LearnedForce* force = force_for(learned, train, validate);
  // No model is told that errs more, on runs that judge, than the one without what was learned: by more than chance.
  if (force != nullptr && conclusion.reported.finite && !judged_here(train, validate)) {
    const likelihood::Fit& without =
        names_claim(conclusion.verdict) || helps(gain) ? conclusion.reported : conclusion.reported_base;
    const double more = raises_error(vehicle, likelihood::model_of(without.hypothesis, input_step),
                                     learning::as_model(learned.fit.hypothesis, input_step, force), unseen);
    if (1.0 + more > learning.limits.judged) {
      force = nullptr;
      result.correction->adopted = result.correction->carried = result.correction->goes_on = false;
      result.correction->refused = learning::too_little("error on runs that judge, over the model's without it",
                                                        1.0 + more, "at most", learning.limits.judged);
    }
  }
  const likelihood::Fit& named = force != nullptr ? learned.fit : conclusion.reported;
  // Stand-ins stay where they help.
  const bool with_names = force != nullptr || names_claim(conclusion.verdict) || helps(gain);
  const likelihood::Fit& best = with_names ? named : conclusion.reported_base;
  if (conclusion.reported.finite) {
    const model::Model before = likelihood::model_of(conclusion.reported_base.hypothesis, input_step);
    const model::Model after = learning::as_model(best.hypothesis, input_step, force);
    judge_predictions(vehicle, before, after, unseen, train, report, answer.given, conclusion);
    if (force != nullptr) tell_of_spread(problem, learned, *force, input_step, unseen, *result.correction);
  }
  if (conclusion.verdict == Verdict::no_model) {
    if (!wiring_sought) seek_wiring(vehicle, train, result, conclusion);
    seek_reason(vehicle, train, settings.thresholds, conclusion);
    const bool corrected = result.correction && result.correction->adopted;
    if (corrected && force != nullptr && result.improvement.low > 0.0) {
      // What the force does on such an axis is known, of its numbers and of its thrust nothing is.
      conclusion.reasons.push_back(
          {inference::Cause::kFreeForce, result.correction->log_odds, learning.limits.odds, std::string{kLearned}});
    } else if (corrected) {
      result.correction->adopted = result.correction->carried = false;
      result.correction->refused = "on runs that no fit has seen it does not surely lower the error";
    }
  }
  begins_later(report, conclusion);
  answer.verdict = conclusion.verdict;
  result.verdict = word(conclusion.verdict);
  result.paragraph = paragraph(conclusion);
  for (const inference::Reason& reason : conclusion.reasons)
    answer.given.causes.push_back({std::string(word(reason.cause)), reason.value, reason.threshold, reason.of});
  // Of the one-step likelihood, whose information is that of independent innovations, and of what differs between runs.
  const auto deviations = [&](const likelihood::Fit& fit) {
    if (!fit.finite) return Eigen::VectorXd{};
    return after_the_commands_clock(problem, fit, likelihood::between_runs(problem, fit, settings.threads).sigma);
  };
  const Eigen::VectorXd of_base = with_difference(conclusion.found.base.fit, conclusion.reported_base,
                                                  deviations(conclusion.found.base.fit)),
                        of_named = force != nullptr ? named.sigma()
                                                    : with_difference(conclusion.found.best.fit, named,
                                                                      deviations(conclusion.found.best.fit));
  const std::set<int> withheld = withheld_axes(conclusion);
  bool told = false;
  for (int axis = 0; axis < 6; ++axis)
    told =
        told || (conclusion.reported.finite && vehicle.dof[static_cast<std::size_t>(axis)] && !withheld.contains(axis));
  list_effects(conclusion, named, of_named, with_names && told, result);
  list_refused(conclusion.found, result, answer.given);
  for (const std::string& name : settings.without)
    result.candidates.push_back({.name = name, .log_odds = kNotAsked, .reason = "taken out of the list"});
  const model::Scene scene = model::scene_of(vehicle, train);
  list_not_asked(scene, result);
  for (const model::Candidates::Idle& idle : answer.candidates.idle)
    result.candidates.push_back({.name = idle.name, .log_odds = kNotAsked, .reason = idle.reason});
  result.not_measured = preflight::not_measured(scene);
  result.manoeuvre = next_motion(result);
  answer.score = conclusion.found.best.score;
  answer.velocities = scored_velocities(problem);
  answer.best = best;
  answer.best_sigma = with_names ? of_named : of_base;
  answer.rivals = names_claim(conclusion.verdict) ? rivals_in(conclusion, named) : std::nullopt;
  if (told) {
    put_covariance(best, answer.best_sigma, answer.given, withheld);
    result.parameters_before = numbers_of(conclusion.reported_base, of_base, withheld);
    result.parameters_after = numbers_of(best, answer.best_sigma, withheld);
  }
  return answer;
}

}  // namespace fathom::verdict
