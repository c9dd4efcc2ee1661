// Matched increments: what a reference moved over a window against the integral of a sensor over the same window.
// Nothing is differentiated, so no smoothing filter can masquerade as a scale error. Unknown: a 3x3 matrix on the
// sensor, a few linear terms, and the delay of the sensor's clock behind the reference's.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "common/estimation/timeline.hpp"

namespace fathom::consistency {

using estimation::PoseSeries;
using estimation::Series;
using estimation::Spline;
using estimation::typical_step;

/// y = sum_s basis_s (M x(t_s + delay)) + fixed * theta, one line of three per window.
struct IncrementProblem {
  struct Window {
    int first{};  ///< index of the first reference sample
    int count{};  ///< samples in the window
    int basis{};  ///< index of its first basis matrix
  };
  std::vector<double> t;  ///< s, reference samples
  std::vector<Window> windows;
  std::vector<Eigen::Vector3d> y;                               ///< per window
  std::vector<Eigen::Matrix3d> basis;                           ///< quadrature weight included
  std::vector<Eigen::Matrix<double, 3, Eigen::Dynamic>> fixed;  ///< per window
  int fixed_columns{};
  int lever{-1};            ///< first of the lever arm's three fixed columns
  double lever_noise{};     ///< mean square of such a column if the attitude were still, from its noise
  double squared_weight{};  ///< mean of the windows' sums of squared quadrature weights over the step, s
  double step{};            ///< s, of the reference
};

/// What one recording says. theta = [M by columns (9), fixed].
struct IncrementFit {
  bool ok{false};
  std::string why_not;      ///< when not ok
  double delay{};           ///< s, sensor lags the reference: sensor(t + delay) belongs to reference(t)
  bool delay_found{false};  ///< false: the optimum lies at the edge, or the motion hides a delay; theta is that of none
  double unseen_delay{};    ///< s, one sigma of a delay that was not found and may be there
  Eigen::VectorXd per_delay;  ///< 1/s, by how much theta would change with it
  Eigen::VectorXd theta;
  Eigen::VectorXd theta_upper;  ///< with the sensor's noise taken out of the normal equations: brackets the truth
  std::vector<double> delay_replicates;               ///< delete-block
  std::vector<Eigen::VectorXd> theta_replicates;      ///< delete-block
  std::vector<double> delay_information;              ///< per block: second derivative of the sum of squares, 1/s^2
  std::vector<Eigen::MatrixXd> information;           ///< per block: normal matrix of theta
  double noise{};                                     ///< mean square of a window's misfit, more if it has a memory
  double explained{};                                 ///< robust R^2
  Eigen::Vector3d residual{Eigen::Vector3d::Zero()};  ///< robust sigma of the windows' misfit per axis, in units of y
  bool lever_seen[3]{};                               ///< the vehicle turned far more than the attitude's noise
  std::vector<double> outlier_times;                  ///< s, windows that miss by more than the limit
  double seconds{};                                   ///< s of data used
};

struct IncrementOptions {
  double longest_delay{1.1};  ///< s
  bool search_delay{true};
  double outlier_floor{};  ///< smallest misfit that counts as outlier, units of y
  bool quick{false};       ///< coarse search only: delay, theta, explained
};

[[nodiscard]] IncrementFit fit_increments(const IncrementProblem& problem, const Series& sensor,
                                          const IncrementOptions& options);

/// Quadrature weights of one window: trapezoids with an end correction (error of fourth order in the step).
[[nodiscard]] std::vector<double> quadrature_weights(const double* t, int count);

}  // namespace fathom::consistency
