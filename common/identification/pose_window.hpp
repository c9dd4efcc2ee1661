// What a model leaves of one window of velocities, places and attitudes, when the window may begin at any of them.
#pragma once

#include <Eigen/Core>
#include <array>
#include <span>
#include <vector>

#include "common/identification/window_residual.hpp"

namespace fathom::identification {

/// Signals: 0..5 velocity in B [m/s, rad/s], 6..8 place in W [m], 9..11 attitude (turn from the measured one, rotation
/// vector in W) [rad].
inline constexpr int kSignals = 12;
using SignalVector = Eigen::Matrix<double, kSignals, 1>;

/// Where a window begins: its velocity, and how far its pose is from the measured one.
using WindowStart = SignalVector;

/// Residual rows of one window, signal after signal: valid samples of what is simulated and was observed.
class PoseWindow {
 public:
  PoseWindow(const model::Window& window, const model::Vehicle& vehicle);

  /// One row: sample of the window, signal.
  struct Row {
    int sample;
    int signal;
  };

  [[nodiscard]] Eigen::Index rows() const { return static_cast<Eigen::Index>(rows_.size()); }
  [[nodiscard]] const Row& row(Eigen::Index i) const { return rows_[static_cast<std::size_t>(i)]; }
  /// Where each signal has its rows.
  [[nodiscard]] std::span<const AxisRows> signals() const { return signals_; }
  [[nodiscard]] const model::Window& window() const { return window_; }
  /// Entries of WindowStart that are free: those of the simulated axes.
  [[nodiscard]] std::span<const int> free() const { return free_; }
  /// As measured.
  [[nodiscard]] WindowStart measured_start() const;

  /// Simulated minus measured, in units of each signal. Not finite where the simulation diverged.
  void evaluate(const model::Model& model, const WindowStart& start, Eigen::Ref<Eigen::VectorXd> residual) const;
  /// Derivatives by forward differences: with respect to the scaled parameters (zero for those that are not `moving`),
  /// then to the free entries of the start. `residual` is that at the same place.
  [[nodiscard]] Eigen::MatrixXd jacobian(const model::Model& model, const ParameterMap& map,
                                         std::span<const Eigen::Index> moving, const WindowStart& start,
                                         const Eigen::VectorXd& residual) const;

 private:
  model::Window window_;
  std::vector<Row> rows_;
  std::vector<AxisRows> signals_;
  std::vector<int> free_;
};

/// Windows of `length` seconds in which poses can be told, one after the other; empty when there are none.
[[nodiscard]] std::vector<PoseWindow> pose_windows(const model::Vehicle& vehicle, std::span<const Trial> trials,
                                                   double length);

}  // namespace fathom::identification
