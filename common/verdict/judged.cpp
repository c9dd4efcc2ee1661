#include "common/verdict/judged.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "common/identification/sparse.hpp"
#include "common/learning/left_out.hpp"
#include "common/learning/spread.hpp"
#include "common/learning/wording.hpp"
#include "common/residual/force_residual.hpp"
#include "common/residual/prediction.hpp"
#include "common/residual/traces.hpp"
#include "common/residual/unseen_event.hpp"
#include "common/residual/whiteness.hpp"
#include "common/verdict/lists.hpp"
#include "common/verdict/skill.hpp"

namespace fathom::verdict {
namespace {

using inference::Conclusion;
using inference::Verdict;

constexpr double kStep = 0.04;    // s between the velocities that are predicted: short of it there is only noise
constexpr double kEvident = 0.1;  // of the error: what falls by so much needs no interval, where none can be given

std::vector<Trial> in_steps(std::span<const Trial> trials) {
  std::vector<Trial> sparse;
  for (const Trial& trial : trials) sparse.push_back(identification::sparse(trial, kStep));
  return sparse;
}

}  // namespace

Judges::Judges(const model::Vehicle& craft, std::span<const Trial> train, std::span<const Trial> validate)
    : vehicle(craft), fitted(train), recorded(validate), unseen(in_steps(validate)) {
  for (const Trial& trial : validate) input_step = std::max(input_step, trial.input_step);
  here = !validate.empty() && std::ranges::all_of(validate, [&](const Trial& judging) {
    return std::ranges::any_of(train, [&](const Trial& of_fit) { return same_run(judging, of_fit); });
  });
}

residual::Foreseen Judges::windows(const model::Model& before, const model::Model& after) const {
  return residual::foreseen(residual::prediction_windows(unseen, residual::lead_of(after)),
                            std::array{&before, &after});
}

const model::LearnedForce* force_for(const learning::Learned& learned, const Judges& judges) {
  if (judges.recorded.empty() || judges.here) return learned.here.get();
  const bool later = std::ranges::all_of(
      judges.recorded, [&](const Trial& judging) { return judging.size() > 0 && judging.t.front() >= learned.until; });
  return later ? learned.later.get() : learned.elsewhere.get();
}

bool helps(const Interval& gain) { return gain.low > 0.0 || (std::isinf(gain.low) && gain.value > kEvident); }

Interval gain_of(const Judges& judges, const model::Model& before, const model::Model& after) {
  const std::vector<model::Window> windows = judges.windows(before, after).windows;
  if (windows.empty()) return {kNotAsked, kNotAsked, kNotAsked};
  return residual::improvement(residual::predict(before, windows), residual::predict(after, windows), judges.vehicle);
}

Interval held_back(const Judges& judges, const Conclusion& conclusion) {
  return gain_of(judges, likelihood::model_of(conclusion.reported_base.hypothesis, judges.input_step),
                 likelihood::model_of(conclusion.reported.hypothesis, judges.input_step));
}

void judge_predictions(const Judges& judges, const model::Model& before, const model::Model& after,
                       DiagnosisReport& report, VerdictGiven& given, Conclusion& conclusion) {
  DiagnosisResult& result = report.result;
  const auto& [vehicle, train, recorded, unseen, input_step, here] = judges;
  const auto residual_before = residual::wrench_residuals(before, unseen),
             residual_after = residual::wrench_residuals(after, unseen);
  result.error_before.force_rmse = residual::force_rmse(vehicle, residual_before);
  result.error_after.force_rmse = residual::force_rmse(vehicle, residual_after);
  result.residual_before = residual::whiteness(before, unseen, residual_before);
  result.residual_after = residual::whiteness(after, unseen, residual_after);
  report.traces = residual::traces_of(unseen, before, after, residual_before, residual_after);
  given.explainable.clear();
  const auto& free = conclusion.found.free_force;
  for (std::size_t i = 0; free && i < free->explainable.size() && i < conclusion.random.size(); ++i)
    given.explainable.push_back(
        {model::kAxisNames[static_cast<std::size_t>(conclusion.random[i].axis)], free->explainable[i]});
  // The fitted runs are seen by the same steps of time.
  report.unseen_event = residual::unseen_event(after, in_steps(train), unseen);
  const residual::Foreseen foreseen = judges.windows(before, after);
  const std::vector<model::Window>& windows = foreseen.windows;
  if (windows.empty()) return;
  result.foretold = {static_cast<int>(windows.size()), foreseen.cut, foreseen.typical};
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

void tell_of_spread(const Judges& judges, const likelihood::Problem& problem, const learning::Learned& learned,
                    const model::LearnedForce& force, CorrectionGiven& given) {
  const learning::Telling tell = [&](const model::FreeForce& all) {
    if (&force == learned.here.get()) return all;
    return &force == learned.elsewhere.get() ? model::lasting_of(all) : learning::standing_of(problem, all);
  };
  const model::Model model = learning::as_model(learned.fit.hypothesis, judges.input_step, &force);
  const std::vector<model::Window> windows = residual::prediction_windows(judges.unseen, residual::lead_of(model));
  const Vector6d sigma = learning::spread_of(learned.fit, force.visited(), tell, judges.input_step, windows);
  std::copy(sigma.begin(), sigma.end(), given.prediction_std.begin());
  given.not_visited = learning::not_visited(learned.fit.hypothesis.model, force, judges.unseen);
  given.words += learning::spread_sentence(given);
}

}  // namespace fathom::verdict
