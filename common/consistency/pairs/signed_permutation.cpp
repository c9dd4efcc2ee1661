#include "common/consistency/pairs/signed_permutation.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <limits>

namespace fathom::consistency {

std::vector<Eigen::Matrix3d> signed_permutations() {
  std::vector<Eigen::Matrix3d> all;
  std::array<int, 3> order{0, 1, 2};
  do {
    for (int signs = 0; signs < 8; ++signs) {
      Eigen::Matrix3d P = Eigen::Matrix3d::Zero();
      for (int k = 0; k < 3; ++k) P(order[static_cast<std::size_t>(k)], k) = (signs >> k) & 1 ? -1.0 : 1.0;
      all.push_back(P);
    }
  } while (std::next_permutation(order.begin(), order.end()));
  return all;
}

Eigen::Matrix3d nearest_permutation(const Eigen::Matrix3d& M, const std::array<bool, 3>& seen) {
  Eigen::Matrix3d best = Eigen::Matrix3d::Identity();
  double best_score = -std::numeric_limits<double>::infinity();
  for (const Eigen::Matrix3d& P : signed_permutations()) {
    double score = 0.02 * P.trace() + 0.01 * (P.determinant() > 0.0 ? 1.0 : 0.0);
    for (int k = 0; k < 3; ++k) {
      if (seen[static_cast<std::size_t>(k)]) score += M.col(k).normalized().dot(P.col(k));
    }
    if (score > best_score) {
      best_score = score;
      best = P;
    }
  }
  return best;
}

}  // namespace fathom::consistency
