#include "common/base/factors.hpp"

#include <Eigen/Eigenvalues>

namespace fathom {

SymmetricFactor::SymmetricFactor(const Eigen::Ref<const Eigen::MatrixXd>& A) : ldlt_{A} {}

Eigen::VectorXd SymmetricFactor::solve(const Eigen::Ref<const Eigen::VectorXd>& b) const { return ldlt_.solve(b); }

Eigen::MatrixXd SymmetricFactor::solve_columns(const Eigen::Ref<const Eigen::MatrixXd>& B) const {
  return ldlt_.solve(B);
}

Eigen::MatrixXd SymmetricFactor::inverse() const {
  return ldlt_.solve(Eigen::MatrixXd::Identity(ldlt_.rows(), ldlt_.rows()));
}

Eigen::VectorXd solve_symmetric(const Eigen::Ref<const Eigen::MatrixXd>& A,
                                const Eigen::Ref<const Eigen::VectorXd>& b) {
  return SymmetricFactor{A}.solve(b);
}

Eigen::MatrixXd inverse_symmetric(const Eigen::Ref<const Eigen::MatrixXd>& A) { return SymmetricFactor{A}.inverse(); }

SymmetricEigen symmetric_eigen(const Eigen::MatrixXd& A) {
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver{A};
  return {solver.eigenvalues(), solver.eigenvectors(), solver.info() == Eigen::Success};
}

InertiaFactor::InertiaFactor(const Matrix6d& M) : lu_{M} {}

Vector6d InertiaFactor::solve(const Vector6d& wrench) const { return lu_.solve(wrench); }

}  // namespace fathom
