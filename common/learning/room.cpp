#include "common/learning/room.hpp"

#include <algorithm>
#include <cmath>

namespace fathom::learning {
namespace {

using model::Quantity;

constexpr double kLeastReach = 0.5;  // m

}  // namespace

Room::Room(const likelihood::Problem& problem) {
  std::array<double, 4> low{problem.t_low, 1e300, 1e300, 1e300}, high{problem.t_high, -1e300, -1e300, -1e300};
  for (const likelihood::RunData& run : problem.runs) {
    for (const Eigen::Vector3d& p : run.trial().p_WB) {
      for (const std::size_t i : {1, 2, 3}) {
        low[i] = std::min(low[i], p[static_cast<Eigen::Index>(i) - 1]);
        high[i] = std::max(high[i], p[static_cast<Eigen::Index>(i) - 1]);
      }
    }
  }
  for (std::size_t i = 0; i < 4; ++i) {
    middle[i] = 0.5 * (low[i] + high[i]);
    half[i] = std::max(0.5 * (high[i] - low[i]), 0.0);
  }
}

model::Factor Room::factor(std::size_t i) const {
  constexpr std::array kReads{Quantity::kRamp, Quantity::kNorth, Quantity::kEast, Quantity::kDepth};
  return {.quantity = kReads[i], .a = middle[i], .b = half[i]};
}

double Room::reach() const { return std::max(std::hypot(half[1], half[2], half[3]), kLeastReach); }

Room::Along Room::along(const Eigen::Vector3d& n_W) const {
  Along along;
  for (std::size_t i = 0; i < 3; ++i) {
    const double n = n_W[static_cast<Eigen::Index>(i)];
    along.half += std::abs(n) * half[i + 1];
    along.edge += n * middle[i + 1] + std::abs(n) * half[i + 1];
  }
  return along;
}

}  // namespace fathom::learning
