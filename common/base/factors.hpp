#pragma once

#include <Eigen/Cholesky>
#include <Eigen/LU>

#include "common/base/spatial.hpp"

// Decompositions that nearly every mind uses, compiled once: each costs a compiler one to three seconds wherever it is
// written down, and once more for every size. Not for loops that must not allocate; those keep Eigen's of fixed size.

namespace fathom {

/// L D L^T of a symmetric matrix (n x n); what is not positive definite is factored all the same, as Eigen::LDLT does.
class SymmetricFactor {
 public:
  explicit SymmetricFactor(const Eigen::Ref<const Eigen::MatrixXd>& A);
  /// x of A x = b.
  [[nodiscard]] Eigen::VectorXd solve(const Eigen::Ref<const Eigen::VectorXd>& b) const;
  /// X of A X = B.
  [[nodiscard]] Eigen::MatrixXd solve_columns(const Eigen::Ref<const Eigen::MatrixXd>& B) const;
  [[nodiscard]] Eigen::MatrixXd inverse() const;
  /// Diagonal of D.
  [[nodiscard]] Eigen::VectorXd pivots() const { return ldlt_.vectorD(); }

 private:
  Eigen::LDLT<Eigen::MatrixXd> ldlt_;
};

/// x of A x = b, A symmetric.
[[nodiscard]] Eigen::VectorXd solve_symmetric(const Eigen::Ref<const Eigen::MatrixXd>& A,
                                              const Eigen::Ref<const Eigen::VectorXd>& b);
/// Inverse of a symmetric matrix.
[[nodiscard]] Eigen::MatrixXd inverse_symmetric(const Eigen::Ref<const Eigen::MatrixXd>& A);

struct SymmetricEigen {
  Eigen::VectorXd values;   ///< ascending
  Eigen::MatrixXd vectors;  ///< a column each
  bool found{};             ///< false where the iteration did not end
};
[[nodiscard]] SymmetricEigen symmetric_eigen(const Eigen::MatrixXd& A);

/// L U of an inertia (6 x 6, not singular), with partial pivoting; allocates nothing.
class InertiaFactor {
 public:
  explicit InertiaFactor(const Matrix6d& M);
  /// M^-1 of a wrench.
  [[nodiscard]] Vector6d solve(const Vector6d& wrench) const;

 private:
  Eigen::PartialPivLU<Matrix6d> lu_;
};

}  // namespace fathom
