// What a fit by trajectories found: a model, and how well it matches each window.
#pragma once

#include <array>
#include <vector>

#include "common/model/dynamics.hpp"

namespace fathom::identification {

struct FitResult {
  model::Model model;
  Vector6d sigma{Vector6d::Ones()};                  ///< residual scale per axis used as weight, m/s and rad/s
  std::vector<Vector6d> nu0;                         ///< per window, m/s and rad/s
  std::vector<double> window_cost;                   ///< half the sum of squared, weighted residuals per window
  std::vector<std::array<double, 6>> window_square;  ///< sum of squared residuals per window and axis, unweighted
  std::vector<std::array<double, 6>> window_count;   ///< rows per window and axis
  double cost{};                                     ///< sum of window_cost
  bool converged{false};
};

}  // namespace fathom::identification
