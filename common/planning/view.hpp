// A stretch of motion as a fit will see it: what the base parameters change there, and what an effect would.
#pragma once

#include <memory>
#include <vector>

#include "common/identification/trajectories/trajectory_fit.hpp"

namespace fathom::planning {

class View {
 public:
  /// Of a vehicle as its file has it: `trial` without noise, whose nu_sigma weighs. `window` [s].
  View(const model::Vehicle& vehicle, const Trial& trial, double window);
  /// Of measured trials and a model that was fitted to them; `sigma` is what it leaves, m/s and rad/s.
  View(const model::Vehicle& vehicle, std::vector<Trial> trials, const model::Model& model, const Vector6d& sigma,
       double window);
  View(const View&) = delete;
  View& operator=(const View&) = delete;

  /// Change of all weighted residuals, initial velocities free, that the effect would make.
  [[nodiscard]] Eigen::VectorXd change(const model::ActiveEffect& effect) const;
  /// Derivatives by the scaled base parameters, and last by the clock of the commands, in standard deviations of what
  /// a diagnosis knows of it beforehand. Rows as in change().
  [[nodiscard]] const Eigen::MatrixXd& jacobian() const { return jacobian_; }
  [[nodiscard]] std::span<const Trial> trials() const { return trials_; }
  [[nodiscard]] const model::Model& model() const { return at_.model; }
  [[nodiscard]] const Vector6d& sigma() const { return at_.sigma; }
  [[nodiscard]] double window() const { return fit_.settings().window; }

 private:
  [[nodiscard]] Eigen::VectorXd residual(const model::Model& model) const;
  [[nodiscard]] Eigen::VectorXd by_clock() const;

  std::vector<Trial> trials_;
  identification::TrajectoryFit fit_;
  identification::FitResult at_;
  std::vector<Eigen::VectorXd> weight_;  ///< per window and row: less than 1 where it is an outlier
  std::vector<Eigen::MatrixXd> free_;    ///< per window, basis of what the initial velocity can change
  std::vector<Eigen::Index> rows_;       ///< of each window, one after the other
  Eigen::MatrixXd jacobian_;
  Eigen::VectorXd without_;
};

}  // namespace fathom::planning
