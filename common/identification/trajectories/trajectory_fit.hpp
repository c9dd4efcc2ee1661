// Output-error fit: parameters and each window's initial velocity such that simulated trajectories match measured ones.
// The simulation never sees a measured velocity after the window's start, so noise in the states does not bias the
// parameters (Jategaonkar 2015, ch. 4). Solved with Ceres; initial velocities are eliminated by the Schur complement.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "common/identification/trajectories/fit_result.hpp"
#include "common/identification/trajectories/window_residual.hpp"

namespace fathom::identification {

struct FitSettings {
  double window{10.0};  ///< s
  int threads{2};
  int iterations{15};                ///< of the solver, at most
  double tolerance{1e-4};            ///< relative decrease of the cost that ends the solver
  int weight_rounds{2};              ///< how often the residual's scale per axis is measured and the fit repeated
  std::size_t most_windows{100000};  ///< evenly chosen when there are more
};

/// One window's residual and derivatives, weighted as the fit weighs them and with the initial velocity projected out
/// (orthogonally).
struct ProjectedWindow {
  Eigen::VectorXd weight;         ///< per row, 1 unless its axis is an outlier in this window
  Eigen::VectorXd residual;       ///< weighted, projected
  Eigen::MatrixXd jacobian;       ///< with respect to the scaled free parameters, weighted, projected
  Eigen::MatrixXd initial_basis;  ///< orthonormal basis of the initial velocity's weighted columns
};

class TrajectoryFit {
 public:
  TrajectoryFit(const model::Vehicle& vehicle, std::span<const Trial> trials, const FitSettings& settings);

  /// Fits from `start`. With `like`, its sigma and initial velocities are the starting point and sigma is kept (costs
  /// can be compared); without, sigma is found by iteration. `tolerance` replaces that of the settings unless zero.
  [[nodiscard]] FitResult fit(const model::Model& start, const FitResult* like = nullptr, double tolerance = 0.0) const;
  /// Cost of a model with the weights and the initial velocities of a fit.
  [[nodiscard]] double cost(const model::Model& model, const FitResult& like) const;
  /// Residuals and derivatives at a fit, per window.
  [[nodiscard]] std::vector<ProjectedWindow> linearise(const FitResult& fit) const;

  [[nodiscard]] std::span<const WindowResidual> windows() const { return windows_; }
  [[nodiscard]] const model::Vehicle& vehicle() const { return vehicle_; }
  [[nodiscard]] const FitSettings& settings() const { return settings_; }

 private:
  void solve(FitResult& fit, double tolerance) const;
  void score(FitResult& fit) const;
  [[nodiscard]] Vector6d residual_scale(const FitResult& fit) const;

  const model::Vehicle& vehicle_;
  FitSettings settings_;
  std::vector<WindowResidual> windows_;
};

}  // namespace fathom::identification
