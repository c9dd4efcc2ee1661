#include "common/base/factors.hpp"

#include <doctest/doctest.h>

namespace fathom {
namespace {

constexpr double kRounding = 1e-12;  // of numbers of order one

Eigen::MatrixXd positive() {
  Eigen::MatrixXd A(4, 4);
  A << 4, 1, 0, 1, 1, 3, 1, 0, 0, 1, 5, 2, 1, 0, 2, 6;
  return A;
}

}  // namespace

TEST_CASE("factors: a symmetric matrix is solved, inverted and factored, whole or as a block, of one sign or of two") {
  for (const double sign : {1.0, -1.0}) {
    Eigen::MatrixXd A = positive();
    A(0, 0) *= sign;  // the second time it has a way down
    const SymmetricFactor factor{A};
    const Eigen::Vector4d b{1.0, -2.0, 0.5, 3.0};
    CHECK((A * factor.solve(b) - b).norm() < kRounding);
    CHECK((A * factor.solve_columns(Eigen::MatrixXd(positive())) - positive()).norm() < kRounding);
    CHECK((A * factor.inverse() - Eigen::Matrix4d::Identity()).norm() < kRounding);
    CHECK(factor.pivots().prod() == doctest::Approx(A.determinant()));
    CHECK((factor.pivots().minCoeff() > 0.0) == (sign > 0.0));
    const auto corner = A.bottomRightCorner<3, 3>();
    CHECK((corner * solve_symmetric(corner, b.tail<3>()) - b.tail<3>()).norm() < kRounding);
    CHECK((inverse_symmetric(A) - factor.inverse()).norm() < kRounding);
  }
}

TEST_CASE("factors: eigenvalues rise, and their vectors are orthonormal and make the matrix again") {
  const SymmetricEigen eigen = symmetric_eigen(positive());
  CHECK(eigen.found);
  for (Eigen::Index i = 1; i < 4; ++i) CHECK(eigen.values[i] >= eigen.values[i - 1]);
  CHECK((eigen.vectors.transpose() * eigen.vectors - Eigen::Matrix4d::Identity()).norm() < kRounding);
  CHECK((eigen.vectors * eigen.values.asDiagonal() * eigen.vectors.transpose() - positive()).norm() < kRounding);
}

TEST_CASE("factors: an inertia with couplings gives back the wrench") {
  Matrix6d M = Matrix6d::Identity() * 10.0;
  M.topLeftCorner<4, 4>() += positive();
  M(1, 5) = -1.5;  // need not be symmetric: experiments are not
  Vector6d wrench;
  wrench << 1, 2, 3, 4, 5, 6;
  CHECK((M * InertiaFactor{M}.solve(wrench) - wrench).norm() < kRounding);
}

}  // namespace fathom
