// The factored update against the textbook's, for every size, with and without packets that are only partly filled.
#include "common/identification/bierman.hpp"

#include <doctest/doctest.h>

#include <Eigen/Core>
#include <cmath>
#include <random>

using namespace fathom::identification;

TEST_CASE("bierman: P, gain and denominator are those of the plain formulas, for every number of parameters") {
  std::mt19937 engine{5};
  std::normal_distribution<double> normal;
  for (int n = 1; n <= 32; ++n) {
    CAPTURE(n);
    const std::ptrdiff_t m = padded(n);
    Eigen::MatrixXd U = Eigen::MatrixXd::Zero(m, n);
    Eigen::VectorXd D = Eigen::VectorXd::Zero(m), h = Eigen::VectorXd::Zero(m), gain = Eigen::VectorXd::Zero(m);
    for (int j = 0; j < n; ++j) {
      for (int i = 0; i < j; ++i) U(i, j) = 0.5 * normal(engine);
      U(j, j) = 1.0;
      D(j) = std::exp(normal(engine));
    }
    const auto P_of = [&] { return Eigen::MatrixXd(U.topRows(n) * D.head(n).asDiagonal() * U.topRows(n).transpose()); };
    for (int row = 0; row < 5; ++row) {
      for (int i = 0; i < n; ++i) h(i) = i % 3 == row % 3 ? 0.0 : normal(engine);
      const double variance = 0.1 + 0.2 * row;
      const Eigen::MatrixXd P = P_of();
      const Eigen::VectorXd Ph = P * h.head(n);
      const double alpha = variance + h.head(n).dot(Ph);
      const double per_alpha = bierman_update(U.data(), D.data(), h.data(), n, variance, gain.data());
      CHECK(per_alpha == doctest::Approx(1.0 / alpha).epsilon(1e-9));
      CHECK((gain.head(n) - Ph).norm() <= 1e-10 * Ph.norm());
      CHECK((P_of() - (P - Ph * Ph.transpose() / alpha)).norm() <= 1e-10 * P.norm());
      for (int j = 0; j < n; ++j) {
        CHECK(U(j, j) == 1.0);
        CHECK(U.col(j).tail(m - j - 1).isZero(0.0));
      }
      CHECK(D.tail(m - n).isZero(0.0));
      Eigen::VectorXd column = Eigen::VectorXd::Zero(m);
      covariance_column(U.data(), D.data(), n, n / 2, column.data());
      CHECK((column.head(n) - P_of().col(n / 2)).norm() <= 1e-12 * P.norm());
    }
  }
}
