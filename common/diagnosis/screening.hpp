// Fast first look at a candidate: its trajectories change to first order, and everything that the base parameters and
// the initial velocities can imitate is projected out before it may claim any of the residual.
#pragma once

#include <Eigen/Cholesky>
#include <span>
#include <string>
#include <vector>

#include "common/identification/trajectory_fit.hpp"
#include "common/model/effect.hpp"

namespace fathom::diagnosis {

/// A fit with its derivatives, prepared once and used by every candidate. The fit and its problem must outlive it.
class Linearisation {
 public:
  Linearisation(const identification::TrajectoryFit& problem, const identification::FitResult& fit);
  /// The same fit on at most `most` windows, evenly chosen.
  [[nodiscard]] Linearisation thinned(std::size_t most) const;

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
  /// Solves (J'J + prior) x = b for the parameters of the fit.
  [[nodiscard]] Eigen::MatrixXd solve(const Eigen::MatrixXd& b) const { return information_.solve(b); }

 private:
  Linearisation(const identification::TrajectoryFit& problem, const identification::FitResult& fit,
                std::vector<identification::ProjectedWindow> windows, std::vector<std::size_t> places);

  const identification::TrajectoryFit& problem_;
  const identification::FitResult& fit_;
  std::vector<identification::ProjectedWindow> windows_;
  std::vector<std::size_t> places_;
  std::vector<double> window_cost_;
  Eigen::LDLT<Eigen::MatrixXd> information_;
  Eigen::MatrixXd unexplained_;
};

/// What a candidate would do, to first order around its best values.
struct Screened {
  const model::Effect* effect{};
  int variant{};
  std::string variant_name;
  std::vector<double> theta;        ///< best values found
  model::Model base;                ///< the fit's model after the step that its parameters take beside the candidate
  double gain{};                    ///< fall of the cost
  std::vector<double> window_cost;  ///< cost per window with the candidate
  Eigen::VectorXd signature;        ///< change of all residuals that only this candidate can make; unit norm
};

/// Searches the candidate's numbers from `starts`: from the best of them when there are many. Where all that
/// it has gained and the linear picture foretells is less than `worth` (a share of the cost), that picture is believed,
/// and the search ends.
[[nodiscard]] Screened screen(const Linearisation& base, const model::Effect& effect, int variant,
                              const std::string& variant_name, std::span<const std::vector<double>> starts,
                              double worth = 0.0);
/// Goes on from what a thinned linearisation found.
[[nodiscard]] Screened refine(const Linearisation& base, const Screened& rough);

}  // namespace fathom::diagnosis
