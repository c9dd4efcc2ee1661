#include "common/identification/regression/residual_tracing.hpp"

#include <algorithm>
#include <cmath>

namespace fathom::identification {
namespace {

struct Residual {
  double rms{};
  double correlation{};  ///< with the pull
};

Residual residual_of(const AxisRegression& axis, const model::Vehicle& vehicle, std::span<const ManoeuvreRows> runs,
                     const RegressionSettings& settings, std::size_t pull) {
  double n = 0.0, z1 = 0.0, z2 = 0.0, f1 = 0.0, f2 = 0.0, zf = 0.0;
  for (const ManoeuvreRows& run : runs) {
    for (const auto& stretch : run.stretches) {
      const Eigen::MatrixXd columns = columns_of(stretch, axis.axis, axis.candidates, vehicle, settings.v_WF);
      Eigen::VectorXd z = columns.rightCols<1>();
      for (const SelectedTerm& term : axis.together.terms) z -= term.value * columns.col(term.column);
      for (std::size_t i = 0; i < stretch.size(); ++i) {
        const double one = z[static_cast<Eigen::Index>(i)], force = stretch[i].pulls[pull][axis.axis];
        n += 1.0;
        z1 += one;
        z2 += one * one;
        f1 += force;
        f2 += force * force;
        zf += one * force;
      }
    }
  }
  const double spread = (z2 - z1 * z1 / n) * (f2 - f1 * f1 / n);
  return {.rms = std::sqrt(z2 / n), .correlation = spread > 0.0 ? (zf - z1 * f1 / n) / std::sqrt(spread) : 0.0};
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
      const Residual before = residual_of(blind[axis], vehicle, without, settings, pull);
      TracedPull& one = traced.emplace_back();
      one.axis = known[axis].axis;
      one.pull = pull;
      one.before = before.rms;
      one.after = residual_of(known[axis], vehicle, runs, settings, pull).rms;
      one.phi_before = blind[axis].together.phi;
      one.phi_after = known[axis].together.phi;
      one.correlation = before.correlation;
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
