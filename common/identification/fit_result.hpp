// What a fit by trajectories found: a model, how well it matches each window, and how sure its numbers are.
#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <vector>

#include "common/model/dynamics.hpp"
#include "common/samples/estimates.hpp"

namespace fathom::identification {

struct FitResult {
  model::Model model;
  Vector6d sigma{Vector6d::Ones()};                  ///< residual scale per axis used as weight, m/s and rad/s
  std::vector<Vector6d> nu0;                         ///< per window, m/s and rad/s
  std::vector<double> window_cost;                   ///< half the sum of squared, weighted residuals per window
  std::vector<std::array<double, 6>> window_square;  ///< sum of squared residuals per window and axis, unweighted
  std::vector<std::array<double, 6>> window_count;   ///< rows per window and axis
  double cost{};                                     ///< sum of window_cost
  Eigen::MatrixXd covariance;  ///< of the free parameters in physical units, order of ParameterMap
  double freedom{};            ///< windows beyond free parameters: how well the covariance itself is known
  std::vector<std::optional<std::array<double, 2>>> interval95{};  ///< physical units, where it was profiled
  double input_step{};  ///< s, the longest time between inputs; set with the covariance
  bool converged{false};

  [[nodiscard]] std::vector<NamedValue> parameters() const;  ///< with deviations and intervals when covariance is there
  [[nodiscard]] double t95() const;  ///< standard deviations to each side that hold 95 % (Student), with the covariance
};

}  // namespace fathom::identification
