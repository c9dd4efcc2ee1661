// Does an effect carry over to data that had no part in the fit? Cross-validation over blocks and over whole runs, with
// all parameters estimated anew each time, to first order around the fit of all data.
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "common/identification/trajectory_fit.hpp"

namespace fathom::diagnosis {

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
  /// Log-likelihood ratio of the numbers at `places` against zero, by what is left in the windows once they are there:
  /// Wald's statistic W with the covariance that comes of leaving one window out at a time (MacKinnon and White 1985,
  /// HC3, by windows), and m/2 ln(1 + W/m) with m the number of windows that say something of them. What acts in a few
  /// windows only, but there beyond doubt, is not refused for acting seldom.
  [[nodiscard]] double log_likelihood_ratio(std::span<const Eigen::Index> places) const;

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
  Window all_;         ///< sum over all windows and the prior; its square without the prior
  Eigen::VectorXd x_;  ///< the parameters, scaled
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
