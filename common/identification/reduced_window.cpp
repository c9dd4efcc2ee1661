#include "common/identification/reduced_window.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

namespace fathom::identification {

ReducedWindow reduced(const PoseWindow& window, const WindowStart& start, const Eigen::VectorXd& weights,
                      Eigen::MatrixXd J, Eigen::VectorXd residual, double stretch) {
  const auto starts = static_cast<Eigen::Index>(window.free().size());
  const Eigen::Index n = J.cols() - starts;
  J.array().colwise() *= weights.array();
  residual.array() *= weights.array();
  const auto by_start = J.rightCols(starts);
  const WindowStart away = (start - window.measured_start()) / (kFreeStart * kFreeStart);
  Eigen::MatrixXd own = by_start.transpose() * by_start;
  Eigen::VectorXd pull = by_start.transpose() * residual;
  for (Eigen::Index s = 0; s < starts; ++s) {
    own(s, s) += 1.0 / (kFreeStart * kFreeStart);
    pull[s] += away[window.free()[static_cast<std::size_t>(s)]];
  }
  const Eigen::LDLT<Eigen::MatrixXd> factors{own};
  ReducedWindow out;
  out.follow = -factors.solve(by_start.transpose() * J.leftCols(n));
  out.own_step = -factors.solve(pull);
  out.own_gain = -0.5 * pull.dot(out.own_step);
  // Without what another beginning would explain as well.
  const Eigen::MatrixXd projected = J.leftCols(n) + by_start * out.follow;
  const Eigen::VectorXd rest = residual + by_start * out.own_step;
  out.H = projected.transpose() * projected;
  out.g = projected.transpose() * rest;
  const double dt = window.window().trial->dt;
  const auto samples = static_cast<Eigen::Index>(window.window().count);
  const auto stretches = std::max(1L, std::lround(static_cast<double>(samples) * dt / stretch));
  out.scores = Eigen::MatrixXd::Zero(n, stretches);
  for (Eigen::Index i = 0; i < window.rows(); ++i)
    out.scores.col(window.row(i).sample * stretches / samples) += projected.row(i).transpose() * rest[i];
  return out;
}

}  // namespace fathom::identification
