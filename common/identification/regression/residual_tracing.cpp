#include "common/identification/regression/residual_tracing.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace fathom::identification {
namespace {

/// What an axis' selected terms leave, stretch by stretch.
std::vector<Eigen::VectorXd> residuals_of(const AxisRegression& axis, const model::Vehicle& vehicle,
                                          std::span<const ManoeuvreRows> runs, const RegressionSettings& settings) {
  std::vector<Eigen::VectorXd> residuals;
  for (const ManoeuvreRows& run : runs) {
    for (const auto& stretch : run.stretches) {
      const Eigen::MatrixXd columns = columns_of(stretch, axis.axis, axis.candidates, vehicle, settings.v_WF);
      Eigen::VectorXd& z = residuals.emplace_back(columns.rightCols<1>());
      for (const SelectedTerm& term : axis.together.terms) z -= term.value * columns.col(term.column);
    }
  }
  return residuals;
}

double rms(const std::vector<PullTrace>& traces, const Eigen::VectorXd PullTrace::*what) {
  double n = 0.0, square = 0.0;
  for (const PullTrace& one : traces) {
    n += static_cast<double>((one.*what).size());
    square += (one.*what).squaredNorm();
  }
  return std::sqrt(square / n);
}

/// Of the residual before with the pull, means apart.
double correlation(const std::vector<PullTrace>& traces) {
  double n = 0.0, z1 = 0.0, z2 = 0.0, f1 = 0.0, f2 = 0.0, zf = 0.0;
  for (const PullTrace& one : traces) {
    n += static_cast<double>(one.pull.size());
    z1 += one.before.sum();
    z2 += one.before.squaredNorm();
    f1 += one.pull.sum();
    f2 += one.pull.squaredNorm();
    zf += one.before.dot(one.pull);
  }
  const double spread = (z2 - z1 * z1 / n) * (f2 - f1 * f1 / n);
  return spread > 0.0 ? (zf - z1 * f1 / n) / std::sqrt(spread) : 0.0;
}

bool has(const AxisRegression& axis, int column) {
  return std::any_of(axis.together.terms.begin(), axis.together.terms.end(),
                     [&](const SelectedTerm& one) { return one.column == column; });
}

}  // namespace

std::vector<TracedPull> trace_pulls(const model::Vehicle& vehicle, std::span<const ManoeuvreRows> runs,
                                    const RegressionSettings& asked) {
  RegressionSettings settings = asked;
  settings.errors = false;  // what is selected and what is left is asked, not how sure it is
  const std::vector<AxisRegression> known = regress(vehicle, runs, settings);
  std::vector<TracedPull> traced;
  for (std::size_t pull = 0; pull < kPulls.size(); ++pull) {
    const auto& cells = vehicle.hydrodynamics->load_cells;
    if (std::none_of(cells.begin(), cells.end(), [&](const auto& cell) { return cell.of == kPulls[pull]; })) continue;
    std::vector<ManoeuvreRows> without{runs.begin(), runs.end()};
    for (ManoeuvreRows& run : without) {
      for (auto& stretch : run.stretches) {
        for (auto& row : stretch) row.known -= row.pulls[pull];
      }
    }
    const std::vector<AxisRegression> blind = regress(vehicle, without, settings);
    for (std::size_t axis = 0; axis < known.size(); ++axis) {
      TracedPull& one = traced.emplace_back();
      one.axis = known[axis].axis;
      one.pull = pull;
      one.phi_before = blind[axis].together.phi;
      one.phi_after = known[axis].together.phi;
      auto before = residuals_of(blind[axis], vehicle, without, settings);
      auto after = residuals_of(known[axis], vehicle, runs, settings);
      for (std::size_t run = 0, at = 0; run < runs.size(); ++run) {
        for (const auto& stretch : runs[run].stretches) {
          PullTrace& trace = one.traces.emplace_back(run, runs[run].dt, std::move(before[at]), std::move(after[at]));
          trace.pull.resize(static_cast<Eigen::Index>(stretch.size()));
          for (Eigen::Index i = 0; i < trace.pull.size(); ++i)
            trace.pull[i] = stretch[static_cast<std::size_t>(i)].pulls[pull][one.axis];
          ++at;
        }
      }
      one.before = rms(one.traces, &PullTrace::before);
      one.after = rms(one.traces, &PullTrace::after);
      one.correlation = correlation(one.traces);
      for (const SelectedTerm& term : blind[axis].together.terms) {
        if (!has(known[axis], term.column)) {
          one.gained.push_back(known[axis].candidates.names[static_cast<std::size_t>(term.column)]);
        }
      }
    }
  }
  return traced;
}

}  // namespace fathom::identification
