#include "common/base/least_squares.hpp"

#include <Eigen/QR>

namespace fathom {

Eigen::MatrixXd pseudo_inverse(const Eigen::MatrixXd& A) {
  return Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd>{A}.pseudoInverse();
}

Eigen::MatrixXd range_basis(const Eigen::MatrixXd& A) {
  const Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr{A};
  Eigen::MatrixXd basis = Eigen::MatrixXd::Identity(A.rows(), qr.rank());
  basis.applyOnTheLeft(qr.householderQ());
  return basis;
}

LeastSquares least_squares(const Eigen::MatrixXd& A, const Eigen::VectorXd& b, double threshold) {
  Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr;
  qr.setThreshold(threshold);
  qr.compute(A);
  return {qr.solve(b), qr.rank()};
}

}  // namespace fathom
