#include "common/identification/lag_sums.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "common/base/least_squares.hpp"

namespace fathom::identification {
namespace {

constexpr int kTurns = 6;            // of coefficients and phi: the likelihood settles in three or four
constexpr double kCollinear = 1e-9;  // relative pivot of the scaled normal matrix

}  // namespace

LagSums::LagSums(Eigen::Index columns) : columns_{columns} {
  for (auto& line : products_) line.fill(Eigen::MatrixXd::Zero(columns, columns));
}

void LagSums::add(const Eigen::MatrixXd& rows) {
  const Eigen::Index n = rows.rows();
  std::vector<Eigen::Index> last;  // of four finite rows
  Eigen::Index finite = 0;
  for (Eigen::Index k = 0; k < n; ++k) {
    finite = rows.row(k).allFinite() ? finite + 1 : 0;
    if (finite > kMemory) last.push_back(k);
  }
  if (last.empty()) return;
  std::array<Eigen::MatrixXd, kMemory + 1> shifted;
  for (Eigen::Index i = 0; i <= kMemory; ++i) {
    Eigen::MatrixXd& of = shifted[static_cast<std::size_t>(i)];
    of.resize(static_cast<Eigen::Index>(last.size()), columns_);
    for (std::size_t r = 0; r < last.size(); ++r) of.row(static_cast<Eigen::Index>(r)) = rows.row(last[r] - i);
  }
  for (std::size_t i = 0; i <= kMemory; ++i) {
    for (std::size_t j = i; j <= kMemory; ++j) products_[i][j].noalias() += shifted[i].transpose() * shifted[j];
  }
  samples_ += static_cast<int>(last.size());
}

Eigen::MatrixXd LagSums::product(Eigen::Index i, Eigen::Index j) const {
  const auto a = static_cast<std::size_t>(i), b = static_cast<std::size_t>(j);
  return a <= b ? products_[a][b] : Eigen::MatrixXd(products_[b][a].transpose());
}

Eigen::MatrixXd LagSums::whitened(const Eigen::Vector3d& phi, const std::vector<Eigen::Index>& columns) const {
  const Eigen::Vector4d c(1.0, -phi[0], -phi[1], -phi[2]);
  const auto n = static_cast<Eigen::Index>(columns.size());
  Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(n, n);
  for (Eigen::Index i = 0; i <= kMemory; ++i) {
    for (Eigen::Index j = i; j <= kMemory; ++j) {
      if (c[i] * c[j] == 0.0) continue;
      const Eigen::MatrixXd product =
          products_[static_cast<std::size_t>(i)][static_cast<std::size_t>(j)](columns, columns);
      sum += c[i] * c[j] * product;
      if (i != j) sum += c[i] * c[j] * product.transpose();
    }
  }
  return sum;
}

Eigen::Vector3d LagSums::memory_of(const Eigen::VectorXd& c, const std::vector<Eigen::Index>& columns) const {
  const auto lagged = [&](std::size_t i, std::size_t j) {
    return c.dot(products_[std::min(i, j)][std::max(i, j)](columns, columns) * c);
  };
  Eigen::Matrix3d R;
  Eigen::Vector3d r;
  for (std::size_t i = 1; i <= kMemory; ++i) {
    const auto a = static_cast<Eigen::Index>(i) - 1;
    r[a] = lagged(0, i);
    for (std::size_t j = 1; j <= kMemory; ++j) R(a, static_cast<Eigen::Index>(j) - 1) = lagged(i, j);
  }
  return R.trace() > 0.0 ? Eigen::Vector3d(R.ldlt().solve(r)) : Eigen::Vector3d::Zero();  // zero: nothing is left
}

ColouredFit fit_coloured(const LagSums& sums, const std::vector<Eigen::Index>& columns, Eigen::Index target) {
  const auto p = static_cast<Eigen::Index>(columns.size());
  std::vector<Eigen::Index> chosen = columns;
  chosen.push_back(target);
  ColouredFit fit;
  for (int turn = 0; turn < kTurns; ++turn) {
    const Eigen::MatrixXd gram = sums.whitened(fit.phi, chosen);
    const Eigen::VectorXd scale =
        gram.diagonal().head(p).unaryExpr([](double d) { return d > 0.0 ? 1.0 / std::sqrt(d) : 0.0; });
    const LeastSquares solved = least_squares(scale.asDiagonal() * gram.topLeftCorner(p, p) * scale.asDiagonal(),
                                              scale.cwiseProduct(gram.col(p).head(p)), kCollinear);
    fit.rank = static_cast<int>(solved.rank);
    fit.x = scale.cwiseProduct(solved.x);
    Eigen::VectorXd combination(p + 1);
    combination << -fit.x, 1.0;
    fit.sse = std::max(combination.dot(gram * combination), 0.0);
    if (turn + 1 < kTurns) fit.phi = sums.memory_of(combination, chosen);
  }
  return fit;
}

}  // namespace fathom::identification
