// A fit seen as a linear problem: what its parameters and initial velocities can imitate is taken out of residuals, so
// that only the rest may be claimed by a candidate.
#pragma once

#include <Eigen/Cholesky>
#include <span>
#include <vector>

#include "common/identification/trajectory_fit.hpp"

namespace fathom::diagnosis {

/// A fit with its derivatives, prepared once and used by every candidate. The fit and its problem must outlive it.
class Linearisation {
 public:
  Linearisation(const identification::TrajectoryFit& problem, const identification::FitResult& fit);
  /// The same fit on at most `most` windows, evenly chosen.
  [[nodiscard]] Linearisation thinned(std::size_t most) const;
  /// The same fit on at most `most` windows: half of them those that it explains worst, so that what acts in few is not
  /// missed, the others evenly chosen.
  [[nodiscard]] Linearisation telling(std::size_t most) const;

  [[nodiscard]] const identification::TrajectoryFit& problem() const { return problem_; }
  [[nodiscard]] const identification::FitResult& fit() const { return fit_; }
  [[nodiscard]] std::span<const identification::ProjectedWindow> windows() const { return windows_; }
  /// Places of these windows among the problem's.
  [[nodiscard]] std::span<const std::size_t> places() const { return places_; }
  /// Cost per window after the last step of the base parameters.
  [[nodiscard]] std::span<const double> window_cost() const { return window_cost_; }
  /// All residuals, as one column, after that step.
  [[nodiscard]] const Eigen::MatrixXd& unexplained() const { return unexplained_; }
  /// All residuals before it.
  [[nodiscard]] Eigen::VectorXd stacked_residual() const;
  /// Takes out of columns of residuals what base parameters can imitate.
  void remove_base(Eigen::MatrixXd& columns) const;
  /// The step of the base parameters that goes with a residual, inside their limits, made in the model.
  void step_base(const Eigen::VectorXd& residual, model::Model& model) const;
  /// What the fit minimises, per window. An outlier counts for less than its square; a candidate that explains it must
  /// be credited with what that saves, so this is not the sum of the weighted squares.
  [[nodiscard]] std::vector<double> window_costs(const Eigen::VectorXd& residual) const;

 private:
  Linearisation(const identification::TrajectoryFit& problem, const identification::FitResult& fit,
                std::vector<identification::ProjectedWindow> windows, std::vector<std::size_t> places);
  /// On those of these windows, in their order.
  [[nodiscard]] Linearisation on(std::span<const std::size_t> chosen) const;

  const identification::TrajectoryFit& problem_;
  const identification::FitResult& fit_;
  std::vector<identification::ProjectedWindow> windows_;
  std::vector<std::size_t> places_;
  std::vector<double> window_cost_;
  Eigen::LDLT<Eigen::MatrixXd> information_;
  Eigen::MatrixXd unexplained_;
};

}  // namespace fathom::diagnosis
