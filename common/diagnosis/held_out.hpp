// Does an effect carry over to data that had no part in the fit? Cross-validation over blocks and over whole runs, with
// all parameters estimated anew each time, to first order around the fit of all data.
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "common/identification/trajectory_fit.hpp"

namespace fathom::diagnosis {

/// True for what lies inside an effect that has amplitudes (a moment, a place, a time constant): it is known from a few
/// windows alone, and no single step finds it from the others. It keeps its value, and the others set the amplitudes.
[[nodiscard]] bool keeps_its_value(const identification::FreeParameter& number, const model::Model& model);

/// What a fit's windows say of its parameters: enough to leave some of them out without fitting again.
class CrossValidation {
 public:
  CrossValidation(const identification::TrajectoryFit& problem, const identification::FitResult& fit);

  /// Sum of squared residuals of all windows, each predicted from the windows of other folds. `folds`: one number from
  /// 0 up per window.
  [[nodiscard]] double error(std::span<const int> folds) const;
  /// The same when only the numbers at `places` are set by the other folds, and the rest by all windows in their light:
  /// runs of different manoeuvres cannot stand in for each other, but an effect's size must be the same in all of them.
  [[nodiscard]] double error(std::span<const int> folds, std::span<const Eigen::Index> places) const;
  /// The same at the fit of all windows.
  [[nodiscard]] double error() const;

 private:
  struct Window {
    Eigen::MatrixXd information;  ///< J'J
    Eigen::VectorXd gradient;     ///< J'r
    double square{};              ///< r'r

    void operator+=(const Window& other);
    /// r'r after a step of the parameters.
    [[nodiscard]] double after(const Eigen::VectorXd& step) const;
  };
  /// Sum over the windows of one fold.
  [[nodiscard]] Window sum(std::span<const int> folds, int fold) const;

  std::vector<Window> windows_;
  Window all_;  ///< sum over all windows and the prior; its square without the prior
};

/// Share of the error (RMS) that the effect saves on windows left out.
struct HeldOut {
  /// Left out: a fifth of the 30 s blocks, spread over all runs. Where the base model itself cannot be told from the
  /// others, as with axes that are excited one after the other, they had no part in the effect's size alone.
  double blocks{};
  double runs{};  ///< a run at a time had no part in the effect's size; equal to `blocks` with fewer than three runs
};

/// Sum of squared residuals, each block predicted from the other blocks.
[[nodiscard]] double error_left_out(const identification::TrajectoryFit& problem, const identification::FitResult& fit);

/// `places`: where the effect's numbers stand among the parameters of the fit `with` it.
[[nodiscard]] HeldOut held_out(const identification::TrajectoryFit& problem, const CrossValidation& without,
                               const CrossValidation& with, std::span<const Eigen::Index> places);

/// How far apart the predicted velocities of two fits are (RMS), as a share of the measured velocity, on the axis where
/// it is largest.
[[nodiscard]] double prediction_change(const identification::TrajectoryFit& problem,
                                       const identification::FitResult& without, const identification::FitResult& with);

}  // namespace fathom::diagnosis
