#include "common/consistency/increments/increment_normals.hpp"

namespace fathom::consistency {

double noise_of(std::span<const Normals> blocks, const Eigen::VectorXd& theta) {
  Normals all(static_cast<int>(theta.size()));
  for (const Normals& block : blocks) all.add(block, 1.0);
  const double square = all.square(theta) / std::max(3.0 * all.weight, 1e-300);
  Eigen::VectorXd scatter = Eigen::VectorXd::Zero(theta.size());
  for (const Normals& block : blocks) scatter += (block.full() * theta - block.g).cwiseAbs2();
  double ratio = 0.0, count = 0.0;
  for (Eigen::Index j = 0; j < theta.size(); ++j) {
    if (!(all.h(j, j) > 1e-12) || !(square > 0.0)) continue;
    ratio += scatter[j] / (square * all.h(j, j));
    count += 1.0;
  }
  return square * (count > 0.0 ? std::max(ratio / count, 1.0) : 1.0);
}

}  // namespace fathom::consistency
