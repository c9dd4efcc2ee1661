#include "common/identification/trajectories/outlier.hpp"

namespace fathom::identification {

double robust_cost(const Eigen::Ref<const Eigen::VectorXd>& residual, std::span<const AxisRows> axes) {
  double cost = 0.0;
  for (const AxisRows& rows : axes) {
    const double bound = outlier_bound(rows.count);
    const double norm = residual.segment(rows.first, rows.count).norm();
    cost += norm <= bound ? 0.5 * norm * norm : bound * norm - 0.5 * bound * bound;
  }
  return cost;
}

Eigen::VectorXd robust_weight(const Eigen::Ref<const Eigen::VectorXd>& residual, std::span<const AxisRows> axes) {
  Eigen::VectorXd weight = Eigen::VectorXd::Ones(residual.size());
  for (const AxisRows& rows : axes) {
    const double bound = outlier_bound(rows.count);
    const double norm = residual.segment(rows.first, rows.count).norm();
    if (norm > bound) weight.segment(rows.first, rows.count).setConstant(std::sqrt(bound / norm));
  }
  return weight;
}

}  // namespace fathom::identification
