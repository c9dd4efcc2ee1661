#include "common/identification/lag_sums.hpp"

#include <Eigen/Cholesky>
#include <Eigen/QR>
#include <cmath>

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

Eigen::MatrixXd LagSums::whitened(const Eigen::Vector3d& phi) const {
  const Eigen::Vector4d c(1.0, -phi[0], -phi[1], -phi[2]);
  Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(columns_, columns_);
  for (Eigen::Index i = 0; i <= kMemory; ++i) {
    for (Eigen::Index j = 0; j <= kMemory; ++j) {
      if (c[i] * c[j] != 0.0) sum += c[i] * c[j] * product(i, j);
    }
  }
  return sum;
}

ColouredFit fit_coloured(const LagSums& sums, const std::vector<Eigen::Index>& columns, Eigen::Index target) {
  const auto p = static_cast<Eigen::Index>(columns.size());
  std::vector<Eigen::Index> chosen = columns;
  chosen.push_back(target);
  std::array<std::array<Eigen::MatrixXd, LagSums::kMemory + 1>, LagSums::kMemory + 1> product;
  for (Eigen::Index i = 0; i <= LagSums::kMemory; ++i) {
    for (Eigen::Index j = 0; j <= LagSums::kMemory; ++j)
      product[static_cast<std::size_t>(i)][static_cast<std::size_t>(j)] = sums.product(i, j)(chosen, chosen);
  }
  ColouredFit fit;
  for (int turn = 0; turn < kTurns; ++turn) {
    const Eigen::Vector4d c(1.0, -fit.phi[0], -fit.phi[1], -fit.phi[2]);
    Eigen::MatrixXd gram = Eigen::MatrixXd::Zero(p + 1, p + 1);
    for (std::size_t i = 0; i <= LagSums::kMemory; ++i) {
      for (std::size_t j = 0; j <= LagSums::kMemory; ++j)
        gram += c[static_cast<Eigen::Index>(i)] * c[static_cast<Eigen::Index>(j)] * product[i][j];
    }
    const Eigen::VectorXd scale =
        gram.diagonal().head(p).unaryExpr([](double d) { return d > 0.0 ? 1.0 / std::sqrt(d) : 0.0; });
    Eigen::ColPivHouseholderQR<Eigen::MatrixXd> solver;
    solver.setThreshold(kCollinear);
    solver.compute(scale.asDiagonal() * gram.topLeftCorner(p, p) * scale.asDiagonal());
    fit.rank = static_cast<int>(solver.rank());
    fit.x = scale.cwiseProduct(solver.solve(scale.cwiseProduct(gram.col(p).head(p))));
    Eigen::VectorXd combination(p + 1);
    combination << -fit.x, 1.0;
    fit.sse = std::max(combination.dot(gram * combination), 0.0);
    if (turn + 1 == kTurns) break;
    Eigen::Matrix3d R;
    Eigen::Vector3d r;
    for (Eigen::Index i = 1; i <= LagSums::kMemory; ++i) {
      const auto a = static_cast<std::size_t>(i);
      r[i - 1] = combination.dot(product[0][a] * combination);
      for (Eigen::Index j = 1; j <= LagSums::kMemory; ++j)
        R(i - 1, j - 1) = combination.dot(product[a][static_cast<std::size_t>(j)] * combination);
    }
    if (!(R.trace() > 0.0)) break;  // nothing is left
    fit.phi = R.ldlt().solve(r);
  }
  return fit;
}

}  // namespace fathom::identification
