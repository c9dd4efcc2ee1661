#include "common/likelihood/curvature.hpp"

#include <Eigen/Cholesky>
#include <cmath>

namespace fathom::likelihood {

void Curvature::learn(const Eigen::MatrixXd& information, const Eigen::VectorXd& s, const Eigen::VectorXd& y) {
  const double along = y.dot(s);
  if (!(along > 0.0)) return;  // no maximum along it
  if (beyond_.rows() != s.size()) beyond_ = Eigen::MatrixXd::Zero(s.size(), s.size());
  const Eigen::VectorXd rest = y - information * s;
  // What was learned elsewhere counts for no more than what is seen here.
  const double was = std::abs(s.dot(beyond_ * s)), is = std::abs(s.dot(rest));
  if (was > is) beyond_ *= is / was;
  const Eigen::VectorXd miss = rest - beyond_ * s;
  beyond_ += (miss * y.transpose() + y * miss.transpose()) / along - miss.dot(s) / (along * along) * y * y.transpose();
}

std::optional<Eigen::MatrixXd> Curvature::corrected(const Eigen::MatrixXd& information) const {
  if (beyond_.rows() != information.rows() || beyond_.rows() == 0) return std::nullopt;
  Eigen::MatrixXd all = information + beyond_;
  const Eigen::VectorXd scale = information.diagonal().cwiseSqrt().cwiseInverse();
  const Eigen::LLT<Eigen::MatrixXd> llt{scale.asDiagonal() * all * scale.asDiagonal()};
  if (llt.info() != Eigen::Success) return std::nullopt;
  return all;
}

}  // namespace fathom::likelihood
