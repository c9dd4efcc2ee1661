#include "common/diagnosis/left_over.hpp"

#include <algorithm>
#include <cmath>

namespace fathom::diagnosis {
namespace {

constexpr double kCertain = 2.0;  // standard errors

constexpr double kGap = 0.1;  // s: a residual that is later than due by more stands after a gap

/// Sum and number of products of an axis' residuals `moment` s apart, and the sum of the early ones' squares.
struct Products {
  double sum{}, count{}, square{};
};

Products products(const identification::WindowResidual& window, const identification::AxisRows& rows,
                  const Eigen::VectorXd& residual, double moment) {
  Products found;
  const Eigen::Index end = rows.first + rows.count;
  for (Eigen::Index early = rows.first, late = rows.first; early < end; ++early) {
    const double later = window.time(early) + moment;
    while (late < end && window.time(late) < later - 1e-6) ++late;
    if (late == end) break;
    if (window.time(late) > later + kGap) continue;
    found.sum += residual[early] * residual[late];
    found.square += residual[early] * residual[early];
    found.count += 1.0;
  }
  return found;
}

}  // namespace

LastingError lasting_error(const identification::TrajectoryFit& problem, const model::Model& model, double lead,
                           double moment) {
  identification::FitResult fit;
  fit.model = model;
  for (const identification::WindowResidual& window : problem.windows())
    fit.nu0.push_back(window.window().trial->nu[window.window().start]);
  const std::vector<identification::ProjectedWindow> projected = problem.linearise(fit);
  Vector6d sum = Vector6d::Zero(), count = Vector6d::Zero(), square = Vector6d::Zero();
  const auto early = [&](const identification::WindowResidual& window) {
    return static_cast<double>(window.window().start) * window.window().trial->dt < lead;
  };
  const bool all = std::ranges::all_of(problem.windows(), early);
  for (std::size_t w = 0; w < problem.windows().size(); ++w) {
    const identification::WindowResidual& window = problem.windows()[w];
    if (!all && early(window)) continue;
    for (const identification::AxisRows& rows : window.axes()) {
      if (rows.count == 0) continue;
      const Products of_window = products(window, rows, projected[w].residual, moment);
      const int axis = window.axis(rows.first);
      sum[axis] += of_window.sum;
      count[axis] += of_window.count;
      square[axis] += of_window.square;
    }
  }
  LastingError lasting;
  for (int axis = 0; axis < 6; ++axis) {
    if (count[axis] <= 0.0) continue;
    lasting.all[axis] = square[axis] / count[axis];
    lasting.square[axis] = std::max(sum[axis] / count[axis], 0.0);
    lasting.error[axis] = lasting.all[axis] / std::sqrt(count[axis]);
  }
  return lasting;
}

bool certainly_lacking(const LastingError& error) {
  return ((error.square - kCertain * error.error).array() > 0.0).any();
}

double share_explained(const LastingError& before, const LastingError& after, const std::array<bool, 6>& random) {
  double weighted = 0.0, weights = 0.0;
  for (int axis = 0; axis < 6; ++axis) {
    if (before.square[axis] <= 0.0 || after.all[axis] <= 0.0) continue;
    const bool noise = random[static_cast<std::size_t>(axis)];
    const double left = noise ? 0.0 : std::max(after.square[axis] - kCertain * after.error[axis], 0.0);
    const double gone = 1.0 - left / before.square[axis];
    if (gone <= 0.0) continue;
    const double weight = std::max(before.square[axis] - after.square[axis], 0.0) / after.all[axis];
    weighted += weight * gone;
    weights += weight;
  }
  if (weights > 0.0) return weighted / weights;
  return certainly_lacking(before) ? 0.0 : 1.0;
}

double at_most_for(double share, double log_odds) {
  if (share >= 1.0) return log_odds;
  return std::min(log_odds, 2.0 * std::log((1.0 - kWholeCause) / (1.0 - share)));
}

}  // namespace fathom::diagnosis
