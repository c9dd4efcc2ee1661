#pragma once

#include <Eigen/Core>

// Rank-revealing decompositions of matrices whose size is known at run time only, compiled once: each of them costs a
// compiler four seconds wherever it is written down.

namespace fathom {

/// Moore-Penrose inverse of A (m x n): n x m, by a complete orthogonal decomposition.
[[nodiscard]] Eigen::MatrixXd pseudo_inverse(const Eigen::MatrixXd& A);

/// Orthonormal columns (m x rank) that span the columns of A (m x n), by Householder QR with column pivoting.
[[nodiscard]] Eigen::MatrixXd range_basis(const Eigen::MatrixXd& A);

struct LeastSquares {
  Eigen::VectorXd x;
  Eigen::Index rank = 0;
};
/// x of smallest |A x - b| among those with `rank` numbers that are not zero, by Householder QR with column pivoting.
/// Pivots below `threshold` times the largest count as zero.
[[nodiscard]] LeastSquares least_squares(const Eigen::MatrixXd& A, const Eigen::VectorXd& b, double threshold);

}  // namespace fathom
