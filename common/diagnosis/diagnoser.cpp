#include "common/diagnosis/diagnoser.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>

#include "common/base/error.hpp"
#include "common/diagnosis/associations.hpp"
#include "common/diagnosis/bent_base.hpp"
#include "common/diagnosis/carried_over.hpp"
#include "common/diagnosis/judgement.hpp"
#include "common/diagnosis/left_over.hpp"
#include "common/diagnosis/moved.hpp"
#include "common/diagnosis/own_run.hpp"
#include "common/diagnosis/random_rest.hpp"
#include "common/diagnosis/search.hpp"
#include "common/residual/unseen_event.hpp"
#include "common/diagnosis/verdict.hpp"
#include "common/identification/sparse.hpp"
#include "common/preflight/wiring.hpp"
#include "common/residual/force_residual.hpp"
#include "common/residual/prediction.hpp"
#include "common/residual/traces.hpp"
#include "common/residual/whiteness.hpp"

namespace fathom::diagnosis {
namespace {

constexpr double kStill = 1e-9;  // m/s, rad/s: rounding of what never changes
constexpr double kStep = 0.04;   // s between the velocities that are predicted: short of it there is only noise

using Residuals = std::vector<std::vector<Vector6d>>;

/// Every run once, however many stretches it has.
std::vector<std::string> names_of(std::span<const Trial> trials) {
  std::vector<std::string> names;
  for (std::size_t r = 0; r < trials.size(); ++r) {
    if (r == 0 || !same_run(trials[r - 1], trials[r])) names.push_back(trials[r].name);
  }
  return names;
}

/// At the rate at which the others are judged.
std::vector<Trial> fitted_as_judged(std::span<const Trial> train) {
  std::vector<Trial> fitted;
  for (const Trial& trial : train) fitted.push_back(identification::sparse(trial, kStep));
  return fitted;
}

/// What is left in the runs that were fitted, and in those that were not: what a model lacks shows in either, and
/// something that grows with a run's time need not be the same in both. A free curve is believed when a residual goes
/// with what it runs over, for noise with a memory goes a little with any curve; unless it took an effect's place.
std::vector<Association> left_in(std::span<const Trial> train, std::span<const Trial> unseen, SearchResult& found,
                                 const model::Model& learnt, const model::Vehicle& vehicle, const Settings& settings) {
  const std::vector<Trial> fitted = fitted_as_judged(train);
  const model::Model& model = found.after.model;
  const std::vector<NamedValue> numbers = found.after.parameters();
  const LeftOver in_fitted{learnt, fitted, residuals_unbent(learnt, fitted, numbers)};
  const LeftOver in_unseen{model, unseen, residuals_unbent(model, unseen, numbers)};
  if (found.free_form && !found.free_form->in_place_of_effect) {
    const auto curves = free_curves(model::scene_of(vehicle, train));
    const auto same = std::ranges::find_if(curves, [&](const auto& curve) {
      return model::kAxisNames[static_cast<std::size_t>(curve->axis())] == found.free_form->axis &&
             name_of(curve->quantity()) == found.free_form->with;
    });
    if (same == curves.end() ||
        std::max(in_fitted.log_odds(**same), in_unseen.log_odds(**same)) < settings.accept_log_odds)
      found.free_form.reset();
  }
  const double odds = settings.accept_log_odds;
  std::vector<Association> left = in_unseen.associations(kSmallestAssociation, odds, kSmallestForce);
  for (Association& other : in_fitted.associations(kSmallestAssociation, odds, kSmallestForce)) {
    const auto same = std::ranges::find_if(
        left, [&](const Association& one) { return one.axis == other.axis && one.with == other.with; });
    if (same == left.end()) left.push_back(std::move(other));
  }
  std::ranges::stable_sort(left, std::greater{}, &Association::share);
  return left;
}

double length_of(std::span<const Trial> trials) {
  double length = 0.0;
  for (const Trial& trial : trials) length += static_cast<double>(trial.size()) * trial.dt;
  return length;
}

/// A table whose columns repeat one number says nothing, however long it is.
void check_moves(const model::Vehicle& vehicle, std::span<const Trial> trials) {
  std::string names;
  for (const Trial& trial : trials) {
    for (std::size_t axis = 0; axis < 6; ++axis) {
      const auto a = static_cast<Eigen::Index>(axis);
      for (std::size_t k = 1; vehicle.dof[axis] && k < trial.size(); ++k) {
        if (std::abs(trial.nu[k][a] - trial.nu[0][a]) > kStill) return;
      }
    }
    names += (names.empty() ? "" : ", ") + trial.name;
  }
  throw InputError(names +
                   ": nothing moves: every velocity and rate that the vehicle simulates is constant there; do "
                   "the columns hold what their names say?");
}

/// Why no prediction could be judged, and how much data would do.
std::string too_short(std::span<const Trial> unseen, const Settings& settings) {
  double longest = 0.0, dt = 0.0;
  for (const Trial& trial : unseen) {
    longest = std::max(longest, static_cast<double>(trial.size()) * trial.dt);
    dt = std::max(dt, trial.dt);
  }
  const double needed = kHorizons.back() + dt;
  char text[256];
  std::snprintf(text, sizeof text,
                "Nothing was judged on data that no fit has seen: that needs %.3g s on end without a gap, and its "
                "longest run has %.3g s. ",
                kHorizons.back(), longest);
  std::string words = text;
  if (settings.held_out > 0.0) {
    std::snprintf(text, sizeof text, "Record at least %.0f s, or give a run of its own to judge by. ",
                  std::ceil(needed / settings.held_out));
  } else {
    std::snprintf(text, sizeof text, "Give a longer run to judge by. ");
  }
  return words + text;
}

/// Said of runs in which nothing ever pushes: a column of zeros is the commonest cause.
std::string never_pushed(const model::Vehicle& vehicle, std::span<const Trial> train) {
  for (const Trial& trial : train) {
    for (const Eigen::VectorXd& input : trial.input) {
      if ((input.array() != 0.0).any()) return "";
    }
  }
  const bool wrench = train.front().input_is_wrench || vehicle.thrusters.empty();
  return std::string(wrench ? "The wrench" : "The thrusters' force") +
         " is zero in every run that was fitted: how the vehicle answers thrust cannot be told; are those columns "
         "filled? ";
}

/// Without the numbers that the effects' forms have no use for.
std::vector<NamedValue> told_parameters(const identification::FitResult& fit) {
  std::vector<NamedValue> values = fit.parameters();
  std::size_t place = values.size();
  for (auto active = fit.model.effects.rbegin(); active != fit.model.effects.rend(); ++active) {
    for (std::size_t i = active->theta.size(); i-- > 0;) {
      --place;
      if (!active->effect->is_told(active->variant, i))
        values.erase(values.begin() + static_cast<std::ptrdiff_t>(place));
    }
  }
  return values;
}

/// Whether the effects help a validation run in which their moments, phases or flows are others: then `found` takes the
/// model with these, and the predictions are those of the run's second half.
bool helps_with_own_numbers(SearchResult& found, const model::Vehicle& vehicle, std::span<const Trial> unseen,
                            const Settings& settings, std::span<const model::Window> windows, Predictions& before,
                            Predictions& after, std::vector<std::string>& effects) {
  if (settings.held_out > 0.0) return false;  // the same run, which has but one of each
  identification::FitSettings fits = settings.fit;
  fits.window = found.window;
  std::optional<OwnRun> own = with_own_numbers(found.after, vehicle, unseen, fits);
  if (!own) return false;
  const std::vector<model::Window> late = second_half(windows, unseen);
  if (late.empty()) return false;
  Predictions plain = predict(found.before.model, late), with = predict(own->model, late);
  const Interval change = improvement(plain, with, vehicle);
  const bool sure = !std::isfinite(change.low) || change.low > 0.0;
  if (!sure || !carries_over(found, change, fall_if_right(found.before.model, own->model, late, with))) return false;
  found.after.model = std::move(own->model);
  before = std::move(plain);
  after = std::move(with);
  effects = std::move(own->effects);
  return true;
}

/// Takes back everything that was accepted.
void take_back(SearchResult& found, const std::string& reason) {
  for (Judged& judged : found.accepted) {
    judged.reason = reason;
    found.refused.insert(found.refused.begin(), judged);  // before other forms of it
  }
  found.accepted.clear();
  found.free_form.reset();  // it was measured beside what is taken back
  found.after = found.before;
}

/// Thrusters that are not those of the vehicle's file bend every number: asked where a model follows its thrust badly.
std::optional<WiringFault> wrongly_wired(const model::Vehicle& vehicle, std::span<const Trial> train,
                                         std::span<const AxisWhiteness> residual, const Settings& settings,
                                         const Progress& progress) {
  if (astray(residual).empty()) return {};
  progress("asking whether thrusters are wired as filed", 0.98);
  return wiring_fault(vehicle, fitted_as_judged(train), settings.fit);
}

}  // namespace

DiagnosisReport diagnose(const model::Vehicle& vehicle, std::span<const Trial> train, std::span<const Trial> validate,
                         const Settings& settings, const Progress& progress, identification::FitResult* fitted) {
  check_moves(vehicle, train);
  std::vector<Trial> unseen;
  for (const Trial& trial : validate) unseen.push_back(identification::sparse(trial, kStep));
  SearchResult found = search(vehicle, train, settings, progress);
  DiagnosisReport report;
  DiagnosisResult& result = report.result;
  result.vehicle = vehicle.name;
  result.train = names_of(train);
  result.validate = names_of(unseen);

  progress("predicting the validation runs", 0.97);
  const std::vector<model::Window> windows = prediction_windows(unseen, lead_of(found.after.model));
  Predictions before = predict(found.before.model, windows);
  Predictions after = predict(found.after.model, windows);
  model::Model learnt = found.after.model;
  report.unseen_event = unseen_event(learnt, fitted_as_judged(train), unseen);
  const bool judged = !before.windows.empty();  // else validation is too short for a single prediction
  if (!found.accepted.empty() && judged &&
      !carries_over(found, improvement(before, after, vehicle),
                    fall_if_right(found.before.model, found.after.model, windows, after)) &&
      !helps_with_own_numbers(found, vehicle, unseen, settings, windows, before, after, result.own_in_validation)) {
    found.taken_back = std::ranges::max_element(found.accepted, {}, &Judged::log_odds)->log_odds;
    take_back(found, kNotCarriedOver);
    after = before;
  }
  const Residuals residual_before = wrench_residuals(found.before.model, unseen);
  Residuals residual_after = wrench_residuals(found.after.model, unseen);
  result.wiring =
      wrongly_wired(vehicle, train, whiteness(found.after.model, unseen, residual_after), settings, progress);
  if (result.wiring) {
    take_back(found, "stands in for thrusters that are not those of the vehicle's file");
    after = before;
    residual_after = residual_before;
  }
  if (!found.accepted.empty()) found.explained = share_on(unseen, found, vehicle, settings);
  if (!found.accepted.empty() && judged && !worth_keeping(found.explained, improvement(before, after, vehicle))) {
    take_back(found, "explains little of what is lacking, and hardly helps the validation run");
    after = before;
    residual_after = residual_before;
  }
  result.error_before = {force_rmse(vehicle, residual_before), before.summary(vehicle)};
  result.error_after = {force_rmse(vehicle, residual_after), after.summary(vehicle)};
  result.improvement = improvement(before, after, vehicle);
  if (!judged) {
    constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
    result.error_before.prediction.clear();
    result.error_after.prediction.clear();
    result.improvement = {kNaN, kNaN, kNaN};
  }
  result.residual_before = whiteness(found.before.model, unseen, residual_before);
  result.residual_after = whiteness(found.after.model, unseen, residual_after);
  if (found.accepted.empty()) {
    learnt = found.after.model;
    result.own_in_validation.clear();
  }
  const std::vector<Association> left = left_in(train, unseen, found, learnt, vehicle, settings);
  if (found.explained < kWholeCause) {
    const std::array<bool, 6> random = random_rest(result.residual_after, left, length_of(unseen));
    found.explained_of_structure = share_on(unseen, found, vehicle, settings, random);
  }
  report.traces = traces_of(unseen, found.before.model, found.after.model, residual_before, residual_after);
  found.after.model = std::move(learnt);
  result.parameters_before = found.before.parameters();
  result.parameters_after = told_parameters(found.after);
  conclude(found, left, model::scene_of(vehicle, train), result,
           never_pushed(vehicle, train) + (judged ? "" : too_short(unseen, settings)));
  if (fitted != nullptr) *fitted = std::move(found.after);
  return report;
}

}  // namespace fathom::diagnosis
