// Regression under noise with a memory: exact against rows whitened by hand, consistent where plain least squares is
// deceived because the regressor answers to the noise, and indifferent to gaps and columns that say the same.
#include "common/identification/lag_sums.hpp"

#include <doctest/doctest.h>

#include <Eigen/Cholesky>
#include <cmath>
#include <limits>
#include <random>

using namespace fathom::identification;

namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

/// Columns 1, x, y with y = 2 - 0.5 x + e, e of first order. `feedback`: x answers to what y was.
Eigen::MatrixXd rows_of(Eigen::Index count, double phi, double feedback, unsigned seed) {
  std::mt19937 random{seed};
  std::normal_distribution<double> normal;
  Eigen::MatrixXd rows(count, 3);
  double e = 0.0;
  for (Eigen::Index k = 0; k < count; ++k) {
    e = phi * e + normal(random);
    const double before = k > 0 ? rows(k - 1, 2) : 0.0;
    const double x = -feedback * before + normal(random);
    rows.row(k) << 1.0, x, 2.0 - 0.5 * x + e;
  }
  return rows;
}

LagSums sums_of(const Eigen::MatrixXd& rows) {
  LagSums sums{rows.cols()};
  sums.add(rows);
  return sums;
}

}  // namespace

TEST_CASE("lag sums: whitened sums are those of rows whitened by hand, gaps left out") {
  Eigen::MatrixXd rows = rows_of(60, 0.5, 0.3, 1);
  rows(20, 1) = kNaN;
  const Eigen::Vector3d phi(0.7, -0.2, 0.1);
  Eigen::MatrixXd expected = Eigen::MatrixXd::Zero(3, 3);
  int samples = 0;
  for (Eigen::Index k = 3; k < 60; ++k) {
    const Eigen::RowVectorXd w =
        rows.row(k) - phi[0] * rows.row(k - 1) - phi[1] * rows.row(k - 2) - phi[2] * rows.row(k - 3);
    if (!w.allFinite()) continue;
    expected += w.transpose() * w;
    ++samples;
  }
  const LagSums sums = sums_of(rows);
  CHECK(sums.samples() == samples);
  CHECK((sums.whitened(phi, {0, 1, 2}) - expected).norm() < 1e-10 * expected.norm());
}

TEST_CASE("lag sums: coefficients are right where the regressor answers to noise with a memory") {
  constexpr int kSeeds = 40;
  double plain_mean = 0.0, mean = 0.0, square = 0.0;
  for (unsigned seed = 0; seed < kSeeds; ++seed) {
    const LagSums sums = sums_of(rows_of(2000, 0.9, 0.5, seed));
    const ColouredFit fit = fit_coloured(sums, {0, 1}, 2);
    CHECK(fit.phi[0] == doctest::Approx(0.9).epsilon(0.15));
    CHECK(fit.rank == 2);
    mean += fit.x[1] / kSeeds;
    square += fit.x[1] * fit.x[1] / kSeeds;
    const Eigen::MatrixXd products = sums.product(0, 0);
    plain_mean += products.topLeftCorner(2, 2).ldlt().solve(products.col(2).head(2))[1] / kSeeds;
  }
  const double error = std::sqrt((square - mean * mean) / kSeeds);
  CHECK(std::abs(mean + 0.5) < 4.0 * error + 1e-3);  // 1e-3: what 2000 samples leave of phi's own bias
  CHECK(plain_mean < -0.8);                          // plain least squares believes that it pushes back
}

TEST_CASE("lag sums: columns that say the same share, and are counted once") {
  const Eigen::MatrixXd one = rows_of(500, 0.6, 0.0, 3);
  Eigen::MatrixXd twice(500, 4);
  twice << one.leftCols(2), 3.0 * one.col(1), one.col(2);
  const ColouredFit single = fit_coloured(sums_of(one), {0, 1}, 2), both = fit_coloured(sums_of(twice), {0, 1, 2}, 3);
  CHECK(both.rank == 2);
  CHECK(both.x[1] + 3.0 * both.x[2] == doctest::Approx(single.x[1]));
  CHECK(both.sse == doctest::Approx(single.sse));
}

TEST_CASE("lag sums: nothing finite, nothing left, too little: no crash") {
  CHECK(sums_of(Eigen::MatrixXd::Constant(50, 3, kNaN)).samples() == 0);
  CHECK(sums_of(Eigen::MatrixXd::Ones(3, 3)).samples() == 0);
  const ColouredFit fit = fit_coloured(sums_of(Eigen::MatrixXd::Zero(50, 3)), {0, 1}, 2);
  CHECK(fit.sse == 0.0);
  CHECK(fit.x.allFinite());
}
