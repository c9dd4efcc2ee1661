#include "common/verdict/by_likelihood.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/diagnosis/applicability.hpp"
#include "common/diagnosis/force_residual.hpp"
#include "common/diagnosis/prediction.hpp"
#include "common/diagnosis/traces.hpp"
#include "common/diagnosis/whiteness.hpp"
#include "common/identification/sparse.hpp"

namespace fathom::verdict {
namespace {

using inference::Conclusion;
using inference::Verdict;
using likelihood::NumberKind;

constexpr double kStep = 0.04;  // s between the velocities that are predicted: short of it there is only noise

std::vector<std::string> names_of(std::span<const Trial> trials) {
  std::vector<std::string> names;
  for (std::size_t r = 0; r < trials.size(); ++r) {
    if (r == 0 || !same_run(trials[r - 1], trials[r])) names.push_back(trials[r].name);
  }
  return names;
}

std::vector<NamedValue> numbers_of(const likelihood::Fit& fit) {
  std::vector<NamedValue> values;
  if (!fit.finite) return values;
  const Eigen::VectorXd sigma = fit.sigma();
  for (std::size_t j = 0; j < fit.numbers.size(); ++j) {
    if (fit.numbers[j].kind == NumberKind::kWeight) continue;
    values.push_back({fit.numbers[j].name, value(fit.hypothesis, fit.numbers[j]), sigma[static_cast<Eigen::Index>(j)],
                      fit.numbers[j].unit});
  }
  return values;
}

/// The learned force for runs that judge: whole on stretches of the runs that it was learned from, else what lasts.
const model::LearnedForce* force_for(const learning::Learned& learned, std::span<const Trial> train,
                                     std::span<const Trial> validate) {
  const bool here = std::ranges::all_of(validate, [&](const Trial& judging) {
    return std::ranges::any_of(train, [&](const Trial& fitted) { return same_run(judging, fitted); });
  });
  return here ? learned.here.get() : learned.elsewhere.get();
}

void list_effects(const Conclusion& conclusion, DiagnosisResult& result, VerdictGiven& given) {
  const inference::Found& found = conclusion.found;
  const auto& effects = found.best.fit.hypothesis.model.effects;
  const std::vector<NamedValue> numbers = numbers_of(found.best.fit);
  for (std::size_t e = 0; e < effects.size() && e < found.odds.size(); ++e) {
    EffectFound effect{.name = std::string(effects[e].effect->name()),
                       .variant = effects[e].variant_name,
                       .log_odds = found.odds[e],
                       .sentence = std::string(effects[e].effect->sentence())};
    for (std::size_t j = 0; j < found.best.fit.numbers.size(); ++j) {
      const likelihood::Number& number = found.best.fit.numbers[j];
      if (number.kind != NumberKind::kEffect || number.index != static_cast<int>(e)) continue;
      NamedValue named = numbers[j];
      named.name = named.name.substr(named.name.find('.') + 1);
      effect.parameters.push_back(std::move(named));
    }
    if (!found.rival[e].empty() && found.probability[e] < inference::Thresholds{}.name_probability)
      effect.alternatives.push_back(
          {.name = found.rival[e],
           .log_odds = std::log(found.probability[e] / std::max(1.0 - found.probability[e], 1e-300))});
    result.candidates.push_back({effect.name, effect.variant, effect.log_odds, 0.0, {}, "accepted"});
    result.effects.push_back(std::move(effect));
  }
  for (const inference::Refused& refused : found.refused) {
    CandidateTried candidate{.name = refused.name, .variant = refused.form};
    for (const inference::Refusal& refusal : refused.refusals) {
      given.refusals[refused.name].push_back({std::string(word(refusal.rule)), refusal.value, refusal.needed});
      if (refusal.rule == inference::Rule::kOdds) candidate.log_odds = refusal.value;
      candidate.reason = std::string(word(refusal.rule));
    }
    result.candidates.push_back(std::move(candidate));
  }
}

}  // namespace

Answer diagnose(const model::Vehicle& vehicle, std::span<const Trial> train, std::span<const Trial> validate,
                const inference::Settings& settings, const inference::Progress& progress,
                const learning::Settings& learning) {
  Answer answer;
  DiagnosisReport& report = answer.report;
  DiagnosisResult& result = report.result;
  answer.given.core = "likelihood";
  result.vehicle = vehicle.name;
  result.train = names_of(train);
  result.validate = names_of(validate);
  const Conclusion conclusion = inference::infer(vehicle, train, settings, progress);
  result.verdict = word(conclusion.verdict);
  result.paragraph = paragraph(conclusion);
  for (const inference::Reason& reason : conclusion.reasons)
    answer.given.causes.push_back({std::string(word(reason.cause)), reason.value, reason.threshold, reason.of});
  list_effects(conclusion, result, answer.given);
  for (const std::string& name : settings.without)
    result.candidates.push_back({.name = name, .reason = "taken out of the list"});
  result.not_measured = diagnosis::not_measured(model::scene_of(vehicle, train));
  learning::Learned learned;
  if (learning.learn && conclusion.verdict == Verdict::unexplained) {
    progress("learning what no list holds", 0.97);
    learned = learning::learn(likelihood::make_problem(vehicle, train, settings.runs), train, conclusion, learning,
                              settings.threads);
    result.correction = learned.given;
  }
  const model::LearnedForce* force = force_for(learned, train, validate);
  const likelihood::Fit& best = force != nullptr ? learned.fit : conclusion.reported;
  constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
  result.improvement = {kNaN, kNaN, kNaN};
  if (!conclusion.reported.finite) return answer;

  const bool numbers = conclusion.verdict != Verdict::no_model;
  if (numbers) {
    result.parameters_before = numbers_of(conclusion.reported_base);
    result.parameters_after = numbers_of(best);
  }
  std::vector<Trial> unseen;
  double input_step = 0.0;
  for (const Trial& trial : validate) {
    unseen.push_back(identification::sparse(trial, kStep));
    input_step = std::max(input_step, trial.input_step);
  }
  const model::Model before = learning::as_model(conclusion.reported_base.hypothesis, input_step);
  const model::Model after = learning::as_model(best.hypothesis, input_step, force);
  const auto residual_before = diagnosis::wrench_residuals(before, unseen),
             residual_after = diagnosis::wrench_residuals(after, unseen);
  const std::vector<model::Window> windows = diagnosis::prediction_windows(unseen, diagnosis::lead_of(after));
  result.error_before.force_rmse = diagnosis::force_rmse(vehicle, residual_before);
  result.error_after.force_rmse = diagnosis::force_rmse(vehicle, residual_after);
  if (!windows.empty()) {
    const diagnosis::Predictions by_before = diagnosis::predict(before, windows),
                                 by_after = diagnosis::predict(after, windows);
    result.error_before.prediction = by_before.summary(vehicle);
    result.error_after.prediction = by_after.summary(vehicle);
    result.improvement = diagnosis::improvement(by_before, by_after, vehicle);
  }
  result.residual_before = diagnosis::whiteness(before, unseen, residual_before);
  result.residual_after = diagnosis::whiteness(after, unseen, residual_after);
  report.traces = diagnosis::traces_of(unseen, before, after, residual_before, residual_after);
  return answer;
}

}  // namespace fathom::verdict
