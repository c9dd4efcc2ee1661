// What counts as an outlier in a fit: one axis of one window whose residual is far from what it should be. Capture
// glitches and collisions must not bend the model, and a fault of one axis says nothing against the others.
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <span>

#include "common/identification/trajectories/window_residual.hpp"

namespace fathom::identification {

/// An axis whose residual is this many times its expected norm pulls no harder than one at that size (Huber).
inline constexpr double kAxisOutlier = 2.5;

/// Norm of `rows` residuals of unit variance beyond which they pull no harder.
[[nodiscard]] inline double outlier_bound(Eigen::Index rows) {
  return kAxisOutlier * std::sqrt(static_cast<double>(rows));
}

/// Half of Huber's loss, axis by axis: what the fit minimises, for one window.
[[nodiscard]] double robust_cost(const Eigen::Ref<const Eigen::VectorXd>& residual, std::span<const AxisRows> axes);
/// Weight per row with which least squares pulls as Huber's loss does at this residual.
[[nodiscard]] Eigen::VectorXd robust_weight(const Eigen::Ref<const Eigen::VectorXd>& residual,
                                            std::span<const AxisRows> axes);

}  // namespace fathom::identification
