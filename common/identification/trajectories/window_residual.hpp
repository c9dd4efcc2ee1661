// What a model leaves of one window: simulated minus measured velocity, and its derivatives.
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "common/identification/trajectories/parameter_map.hpp"
#include "common/model/rollout.hpp"

namespace fathom::identification {

/// Cuts trials into windows of `length` seconds that follow one another, each beginning at a sample with everything
/// valid and keeping at least half of its samples valid.
[[nodiscard]] std::vector<model::Window> cut_windows(std::span<const Trial> trials, double length);

/// Rows of one axis in a window's residual.
struct AxisRows {
  Eigen::Index first;
  Eigen::Index count;
};

/// Residual rows of one window, axis after axis: valid samples of observed, simulated axes, each divided by the axis'
/// `sigma`.
class WindowResidual {
 public:
  WindowResidual(const model::Window& window, const model::Vehicle& vehicle);

  [[nodiscard]] const model::Window& window() const { return window_; }
  [[nodiscard]] Eigen::Index rows() const { return static_cast<Eigen::Index>(rows_.size()); }
  /// Where each observed axis has its rows.
  [[nodiscard]] std::span<const AxisRows> axes() const { return axes_; }
  /// Axis (0..5) of a row.
  [[nodiscard]] int axis(Eigen::Index row) const { return rows_[static_cast<std::size_t>(row)].axis; }
  /// Measured velocity of a row, m/s or rad/s.
  [[nodiscard]] double measured(Eigen::Index row) const {
    const Row& at = rows_[static_cast<std::size_t>(row)];
    return window_.trial->nu[window_.start + static_cast<std::size_t>(at.sample)][at.axis];
  }

  /// When a row was measured, s.
  [[nodiscard]] double time(Eigen::Index row) const {
    return window_.trial->t[window_.start + static_cast<std::size_t>(rows_[static_cast<std::size_t>(row)].sample)];
  }

  /// Simulated minus measured over sigma; `trace` is workspace. False when the simulation diverged.
  bool evaluate(const model::Model& model, const Vector6d& nu0, const Vector6d& sigma, model::VelocityTrace& trace,
                Eigen::Ref<Eigen::VectorXd> residual) const;
  /// Derivatives with respect to the free parameters (scaled; rows x map.size()) and to the initial velocity of the
  /// simulated axes (per m/s, rad/s; rows x 6, zero columns where not simulated). Base parameters and initial velocity
  /// by the variational equation, effects' numbers by forward differences.
  void jacobians(const model::Model& model, const ParameterMap& map, const Vector6d& nu0, const Vector6d& sigma,
                 const Eigen::VectorXd& residual, Eigen::MatrixXd& by_parameter, Eigen::MatrixXd& by_initial) const;

 private:
  struct Row {
    int sample;
    int axis;
  };
  model::Window window_;
  std::vector<Row> rows_;
  std::vector<AxisRows> axes_;
};

}  // namespace fathom::identification
