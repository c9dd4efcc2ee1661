#include "common/diagnosis/diagnoser.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/diagnosis/prediction.hpp"
#include "common/diagnosis/search.hpp"
#include "common/diagnosis/verdict.hpp"
#include "common/diagnosis/whiteness.hpp"

namespace fathom::diagnosis {
namespace {

using Residuals = std::vector<std::vector<Vector6d>>;

std::array<double, 6> as_array(const Vector6d& v) { return {v[0], v[1], v[2], v[3], v[4], v[5]}; }

Residuals residuals_of(const model::Model& model, std::span<const Trial> trials) {
  Residuals residuals;
  for (const Trial& trial : trials) residuals.push_back(wrench_residuals(model, trial));
  return residuals;
}

std::map<std::string, double> force_rmse(const model::Vehicle& vehicle, const Residuals& residuals) {
  std::map<std::string, double> rmse;
  for (std::size_t axis = 0; axis < 6; ++axis) {
    if (!vehicle.dof[axis]) continue;
    double square = 0.0, count = 0.0;
    for (const auto& run : residuals) {
      for (const Vector6d& wrench : run) {
        const double value = wrench[static_cast<Eigen::Index>(axis)];
        if (!std::isfinite(value)) continue;
        square += value * value;
        count += 1.0;
      }
    }
    if (count > 0.0) rmse[model::kAxisNames[axis]] = std::sqrt(square / count);
  }
  return rmse;
}

/// Where the overlaid predictions begin anew: every 10 s, as long as the longest horizon.
std::vector<std::size_t> restarts_of(const Trial& trial) {
  const auto length = std::max<std::size_t>(1, static_cast<std::size_t>(std::lround(kHorizons.back() / trial.dt)));
  std::vector<std::size_t> restarts;
  for (std::size_t start = 0; start < trial.size(); start += length) restarts.push_back(start);
  return restarts;
}

/// Velocities of `model` over the whole trial, restarted at the measured velocity.
void overlay(const model::Model& model, const Trial& trial, std::span<const std::size_t> restarts,
             std::vector<std::array<double, 6>>& out) {
  constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
  out.assign(trial.size(), {kNaN, kNaN, kNaN, kNaN, kNaN, kNaN});
  model::VelocityTrace trace;
  for (std::size_t r = 0; r < restarts.size(); ++r) {
    const std::size_t start = restarts[r];
    const std::size_t count = (r + 1 < restarts.size() ? restarts[r + 1] : trial.size()) - start;
    model::rollout(model, {&trial, start, count}, model::true_velocity(model, trial, start), trace);
    for (std::size_t k = 0; k < count; ++k) {
      for (std::size_t axis = 0; axis < 6; ++axis) {
        if (model.vehicle->dof[axis]) {
          out[start + k][axis] = trace(static_cast<Eigen::Index>(axis), static_cast<Eigen::Index>(k));
        }
      }
    }
  }
}

PredictionTrace trace_of(const Trial& trial, const SearchResult& found, const std::vector<Vector6d>& residual_before,
                         const std::vector<Vector6d>& residual_after) {
  PredictionTrace trace{.run = trial.name, .t = trial.t};
  trace.restarts = restarts_of(trial);
  overlay(found.before.model, trial, trace.restarts, trace.before);
  overlay(found.after.model, trial, trace.restarts, trace.after);
  constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
  for (std::size_t k = 0; k < trial.size(); ++k) {
    std::array<double, 6> measured = as_array(trial.nu[k]);
    for (std::size_t axis = 0; axis < 6; ++axis) {
      const bool valid = axis < 3 ? trial.observed.velocity && trial.velocity_valid[k] != 0
                                  : trial.observed.rates && trial.rates_valid[k] != 0;
      if (!valid) measured[axis] = kNaN;
    }
    trace.measured.push_back(measured);
    trace.residual_before.push_back(as_array(residual_before[k]));
    trace.residual_after.push_back(as_array(residual_after[k]));
    if (trial.observed.position) trace.position.push_back({trial.p_WB[k].x(), trial.p_WB[k].y(), trial.p_WB[k].z()});
    if (trial.observed.attitude) {
      trace.heading.push_back(euler_from_rotation(trial.q_WB[k].toRotationMatrix()).z());
    }
    trace.tau.push_back(as_array(found.before.model.allocation * trial.input[k]));
  }
  trace.voltage = trial.voltage;
  return trace;
}

}  // namespace

DiagnosisReport diagnose(const model::Vehicle& vehicle, std::span<const Trial> train, std::span<const Trial> validate,
                         const Settings& settings, const Progress& progress) {
  const SearchResult found = search(vehicle, train, settings, progress);
  DiagnosisReport report;
  DiagnosisResult& result = report.result;
  result.vehicle = vehicle.name;
  for (const Trial& trial : train) result.train.push_back(trial.name);
  for (const Trial& trial : validate) result.validate.push_back(trial.name);

  progress("predicting the validation runs", 0.97);
  const std::vector<model::Window> windows = prediction_windows(validate);
  const Predictions before = predict(found.before.model, windows);
  const Predictions after = predict(found.after.model, windows);
  const Residuals residual_before = residuals_of(found.before.model, validate);
  const Residuals residual_after = residuals_of(found.after.model, validate);
  result.error_before = {force_rmse(vehicle, residual_before), before.summary(vehicle)};
  result.error_after = {force_rmse(vehicle, residual_after), after.summary(vehicle)};
  result.improvement = improvement(before, after, vehicle);
  result.parameters_before = found.before.parameters();
  result.parameters_after = found.after.parameters();
  result.residual_before = whiteness(found.before.model, validate, residual_before);
  result.residual_after = whiteness(found.after.model, validate, residual_after);
  conclude(found, associations(found.after.model, validate, residual_after, kSmallestAssociation), result);
  for (std::size_t r = 0; r < validate.size(); ++r) {
    report.traces.push_back(trace_of(validate[r], found, residual_before[r], residual_after[r]));
  }
  return report;
}

}  // namespace fathom::diagnosis
