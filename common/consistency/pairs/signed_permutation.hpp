// Axes that were swapped or turned round: matrices with one entry of 1 or -1 in every row and column.
#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

namespace fathom::consistency {

/// All 48, the identity first.
[[nodiscard]] std::vector<Eigen::Matrix3d> signed_permutations();
/// The one nearest to the columns of `M` that were `seen`; the rest stays as near to the identity as it can.
[[nodiscard]] Eigen::Matrix3d nearest_permutation(const Eigen::Matrix3d& M, const std::array<bool, 3>& seen);

}  // namespace fathom::consistency
