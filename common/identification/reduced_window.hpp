// One window's share of the normal equations of a fit by poses, its beginning eliminated.
#pragma once

#include <Eigen/Core>

#include "common/identification/pose_window.hpp"

namespace fathom::identification {

/// m/s, rad/s, m, rad: standard deviation of a window's beginning around the measured one, where no signal tells it.
inline constexpr double kFreeStart = 100.0;

struct ReducedWindow {
  Eigen::MatrixXd H;         ///< n x n
  Eigen::VectorXd g;         ///< n
  Eigen::MatrixXd scores;    ///< n x stretches: gradient of each
  Eigen::MatrixXd follow;    ///< free starts x n: how the beginning follows the numbers
  Eigen::VectorXd own_step;  ///< free starts: what it moves by itself
  double own_gain{};         ///< of the cost, foretold of that
};

/// `J`: derivatives by n numbers, then by the free entries of the start; `weights`: per row. `stretch`: s whose
/// residuals count as one.
[[nodiscard]] ReducedWindow reduced(const PoseWindow& window, const WindowStart& start, const Eigen::VectorXd& weights,
                                    Eigen::MatrixXd J, Eigen::VectorXd residual, double stretch);

}  // namespace fathom::identification
