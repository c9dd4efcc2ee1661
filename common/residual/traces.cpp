#include "common/residual/traces.hpp"

#include <cmath>
#include <limits>

#include "common/residual/prediction.hpp"

namespace fathom::residual {
namespace {

std::array<double, 6> as_array(const Vector6d& v) { return {v[0], v[1], v[2], v[3], v[4], v[5]}; }

PredictionTrace trace_of(const Trial& trial, const model::Model& before, const model::Model& after,
                         const std::vector<Vector6d>& residual_before, const std::vector<Vector6d>& residual_after) {
  PredictionTrace trace{.run = trial.name, .t = trial.t};
  trace.restarts = restarts(trial);
  trace.before = predict_anew(before, trial, trace.restarts);
  trace.after = predict_anew(after, trial, trace.restarts);
  constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
  for (std::size_t k = 0; k < trial.size(); ++k) {
    std::array<double, 6> measured = as_array(trial.nu[k]);
    for (std::size_t axis = 0; axis < 6; ++axis) {
      if (!is_measured(trial, k, axis)) measured[axis] = kNaN;
    }
    trace.measured.push_back(measured);
    trace.residual_before.push_back(as_array(residual_before[k]));
    trace.residual_after.push_back(as_array(residual_after[k]));
    if (trial.observed.position) trace.position.push_back({trial.p_WB[k].x(), trial.p_WB[k].y(), trial.p_WB[k].z()});
    if (trial.observed.attitude) {
      trace.heading.push_back(euler_from_rotation(trial.q_WB[k].toRotationMatrix()).z());
    }
    trace.tau.push_back(as_array(before.allocation * trial.input[k]));
  }
  trace.voltage = trial.voltage;
  return trace;
}

/// Stretches between a run's gaps are one run to whoever looks at it: one row of nothing stands for each gap.
void join(PredictionTrace& run, PredictionTrace&& next) {
  constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
  const auto append = [](auto& to, auto& from, const auto& between) {
    if (from.empty()) return;
    to.push_back(between);
    to.insert(to.end(), from.begin(), from.end());
  };
  for (const std::size_t k : next.restarts) run.restarts.push_back(run.t.size() + 1 + k);
  append(run.t, next.t, 0.5 * (run.t.back() + next.t.front()));
  for (auto rows : {&PredictionTrace::measured, &PredictionTrace::before, &PredictionTrace::after,
                    &PredictionTrace::residual_before, &PredictionTrace::residual_after, &PredictionTrace::tau})
    append(run.*rows, next.*rows, std::array<double, 6>{kNaN, kNaN, kNaN, kNaN, kNaN, kNaN});
  append(run.position, next.position, std::array<double, 3>{kNaN, kNaN, kNaN});
  append(run.heading, next.heading, kNaN);
  append(run.voltage, next.voltage, kNaN);
}

}  // namespace

std::vector<PredictionTrace> traces_of(std::span<const Trial> unseen, const model::Model& before,
                                       const model::Model& after,
                                       std::span<const std::vector<Vector6d>> residual_before,
                                       std::span<const std::vector<Vector6d>> residual_after) {
  std::vector<PredictionTrace> traces;
  for (std::size_t r = 0; r < unseen.size(); ++r) {
    PredictionTrace trace = trace_of(unseen[r], before, after, residual_before[r], residual_after[r]);
    if (r > 0 && same_run(unseen[r - 1], unseen[r])) {
      join(traces.back(), std::move(trace));
    } else {
      traces.push_back(std::move(trace));
    }
  }
  return traces;
}

}  // namespace fathom::residual
