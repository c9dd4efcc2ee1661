#include "common/base/least_squares.hpp"

#include <doctest/doctest.h>

#include <Eigen/Core>

using namespace fathom;

namespace {

constexpr double kRounding = 1e-12;  // of numbers of order one

Eigen::MatrixXd of_rank_two() {  // the third column is the sum of the others
  Eigen::MatrixXd A(4, 3);
  A << 1, 0, 1, 0, 2, 2, 1, 1, 2, 3, -1, 2;
  return A;
}

}  // namespace

TEST_CASE("least squares: what a column of the others adds nothing to is left at zero, and the fit is the same") {
  const Eigen::MatrixXd A = of_rank_two();
  const Eigen::VectorXd b = A * Eigen::Vector3d{1.0, -2.0, 0.5};
  const LeastSquares found = least_squares(A, b, 1e-9);
  CHECK(found.rank == 2);
  CHECK((A * found.x - b).norm() < kRounding);
  CHECK((found.x.array().abs() < kRounding).count() == 1);
}

TEST_CASE("range basis: orthonormal, as many columns as the rank, and all of the matrix lies in it") {
  const Eigen::MatrixXd A = of_rank_two(), Q = range_basis(A);
  CHECK(Q.cols() == 2);
  CHECK((Q.transpose() * Q - Eigen::Matrix2d::Identity()).norm() < kRounding);
  CHECK((Q * (Q.transpose() * A) - A).norm() < kRounding);
}

TEST_CASE("pseudo-inverse: the four conditions of Penrose hold for a matrix without full rank") {
  const Eigen::MatrixXd A = of_rank_two(), P = pseudo_inverse(A);
  CHECK((A * P * A - A).norm() < kRounding);
  CHECK((P * A * P - P).norm() < kRounding);
  CHECK((A * P - (A * P).transpose()).norm() < kRounding);
  CHECK((P * A - (P * A).transpose()).norm() < kRounding);
}
