// The factored update against the textbook's, for every size, with and without packets that are only partly filled.
#include "common/identification/bierman.hpp"

#include <doctest/doctest.h>

#include <Eigen/Core>
#include <cmath>
#include <random>
#include <vector>

using namespace fathom::identification;

TEST_CASE("bierman: P, gain and denominator are those of the plain formulas, for every number of parameters") {
  std::mt19937 engine{5};
  std::normal_distribution<double> normal;
  for (int n = 1; n <= 32; ++n) {
    CAPTURE(n);
    const std::ptrdiff_t m = padded(n);
    Eigen::MatrixXd U = Eigen::MatrixXd::Zero(m, n);
    Eigen::VectorXd D = Eigen::VectorXd::Zero(m), gain = D, x = D, score = D, information = D, free = D;
    Eigen::VectorXd h = Eigen::VectorXd::Constant(m, std::nan(""));  // what lies behind n does not count
    free.head(n).setOnes();
    free(n / 2) = n > 1 ? 0.0 : 1.0;
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
      const Eigen::VectorXd expected = P * h.head(n);
      const double alpha = variance + h.head(n).dot(expected);
      const double y = normal(engine), innovation = y - h.head(n).dot(x.head(n));
      const Eigen::VectorXd x_before = x, score_before = score, information_before = information;
      const auto [residual, per_alpha] = take_row({.U = U.data(),
                                                   .D = D.data(),
                                                   .x = x.data(),
                                                   .score = score.data(),
                                                   .information = information.data(),
                                                   .free = free.data(),
                                                   .n = n},
                                                  h.data(), y, variance, gain.data());
      CHECK(residual == doctest::Approx(innovation * std::sqrt(variance / alpha)).epsilon(1e-9));
      const Eigen::VectorXd moved = (expected * innovation / alpha).cwiseProduct(free.head(n));
      CHECK((x - x_before).head(n).isApprox(moved, 1e-9));
      CHECK((score - score_before).head(n).isApprox(h.head(n) * residual / variance, 1e-9));
      CHECK((information - information_before).head(n).isApprox(h.head(n).cwiseAbs2() / variance, 1e-9));
      for (const Eigen::VectorXd* each : {&x, &score, &information, &gain}) CHECK(each->tail(m - n).isZero(0.0));
      CHECK(per_alpha == doctest::Approx(1.0 / alpha).epsilon(1e-9));
      CHECK((gain.head(n) - expected).norm() <= 1e-10 * expected.norm());
      CHECK((P_of() - (P - expected * expected.transpose() / alpha)).norm() <= 1e-10 * P.norm());
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

TEST_CASE("bierman: sums of scores and broken signs are those of plain loops, for every number of parameters") {
  std::mt19937 engine{6};
  std::normal_distribution<double> normal;
  for (int n = 1; n <= 32; ++n) {
    CAPTURE(n);
    const std::ptrdiff_t m = padded(n);
    constexpr double kKeep = 0.9;
    constexpr int kTogether = 3;
    const Eigen::VectorXd none = Eigen::VectorXd::Zero(m);
    Eigen::VectorXd squares = none, fourth = none, together = none, apart = none;
    Eigen::VectorXd expected = none, expected_fourth = none, expected_together = none, expected_apart = none;
    Eigen::MatrixXd last_scores = Eigen::MatrixXd::Zero(m, kTogether), last_sums = last_scores;
    std::vector<Eigen::VectorXd> scores(2 * kTogether, none);  // none came before
    for (int step = 0; step < 9; ++step) {
      Eigen::VectorXd score = none;
      for (int i = 0; i < n; ++i) score(i) = normal(engine);
      const int oldest = step % kTogether;
      add_scores({.squares = squares.data(),
                  .fourth = fourth.data(),
                  .together = together.data(),
                  .apart = apart.data(),
                  .sum = last_sums.col((oldest + kTogether - 1) % kTogether).data(),
                  .oldest_score = last_scores.col(oldest).data(),
                  .oldest_sum = last_sums.col(oldest).data(),
                  .n = n},
                 score.data(), kKeep);
      scores.push_back(score);
      Eigen::VectorXd sum = none, sum_before = none;
      for (int k = 0; k < kTogether; ++k) {
        sum += scores[scores.size() - 1 - static_cast<std::size_t>(k)];
        sum_before += scores[scores.size() - 1 - static_cast<std::size_t>(k + kTogether)];
      }
      expected = kKeep * expected + score.cwiseAbs2();
      expected_fourth = kKeep * expected_fourth + score.cwiseAbs2().cwiseAbs2();
      expected_together = kKeep * expected_together + sum.cwiseAbs2();
      expected_apart = kKeep * expected_apart + sum.cwiseProduct(sum_before);
    }
    CHECK((squares - expected).norm() <= 1e-12 * expected.norm());
    CHECK((fourth - expected_fourth).norm() <= 1e-12 * expected_fourth.norm());
    CHECK((together - expected_together).norm() <= 1e-12 * expected_together.norm());
    CHECK((apart - expected_apart).norm() <= 1e-12 * expected_together.norm());
    const Eigen::VectorXd last = scores.back(), before = scores[scores.size() - 2];
    Eigen::VectorXd sign = Eigen::VectorXd::Zero(m);
    std::uint32_t broken = 0;
    for (int i = 0; i < n; ++i) {
      sign(i) = i % 3 - 1;
      if (last(i) * sign(i) < 0.0) broken |= 1U << i;
    }
    CHECK(violated(last.data(), sign.data(), n) == broken);
    Eigen::VectorXd sum = last;
    add_multiple(sum.data(), 2.5, before.data(), n);
    CHECK((sum - last - 2.5 * before).norm() <= 1e-12 * sum.norm());
  }
}
