// The least-squares step that stays inside bounds (Stark and Parker 1995): which numbers a fit will press against them.
#pragma once

#include <Eigen/Core>

namespace fathom::identification {

/// Minimises 1/2 d' A d + g' d over low <= d <= high, all n numbers (low <= 0 <= high). A must be positive definite.
[[nodiscard]] Eigen::VectorXd box_step(const Eigen::MatrixXd& A, const Eigen::VectorXd& g, const Eigen::VectorXd& low,
                                       const Eigen::VectorXd& high);

}  // namespace fathom::identification
