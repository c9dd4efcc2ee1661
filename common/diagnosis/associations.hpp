// What structure is left in a residual: measured quantities, moments and frequencies that it goes with. Noise with a
// memory goes with nothing, although a pilot or an autopilot answers to it: the residual's own past is accounted for,
// and so is what such noise does to the base model's numbers.
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "common/diagnosis/free_curve.hpp"
#include "common/diagnosis/suspects.hpp"
#include "common/identification/lag_sums.hpp"
#include "common/model/dynamics.hpp"
#include "common/samples/diagnosis_result.hpp"

namespace fathom::diagnosis {

/// A residual, samples as far apart as it is smoothed, and what may be asked of it.
class LeftOver {
 public:
  /// `residuals`: of `trials`, as wrench_residuals() gives them. Model and trials must outlive it.
  LeftOver(const model::Model& model, std::span<const Trial> trials, std::span<const std::vector<Vector6d>> residuals);

  /// With at least this share, these log odds, and this size where a wrench is applied along the axis at all; largest
  /// share first.
  [[nodiscard]] std::vector<Association> associations(double share, double log_odds, double of_wrench) const;
  /// Natural log odds that the residual goes with what the curve runs over.
  [[nodiscard]] double log_odds(const FreeCurve& curve) const;

 private:
  struct Run {
    const Trial* trial;
    double step;                   ///< s from sample to sample
    std::vector<Moment> at;        ///< one for each sample
    std::vector<Vector6d> wrench;  ///< N, N m
  };
  static constexpr int kSamplesPerColumn = 5;  // fewer tell nothing
  [[nodiscard]] static bool always(const Trial&) { return true; }
  using Asked = std::function<void(const Moment&, Columns&)>;
  struct Answer {
    double share{};
    double log_odds{-1.0};
  };

  /// Base columns, those asked, and the residual, run by run; runs that do not have the quantity are left out.
  [[nodiscard]] std::vector<Eigen::MatrixXd> rows(int axis, bool (*seen)(const Trial&), const Asked& asked) const;
  /// `hidden`: parameters that had been chosen before the columns were made.
  [[nodiscard]] Answer answer(const identification::LagSums& sums, const std::vector<Eigen::Index>& asked,
                              double hidden) const;
  [[nodiscard]] Answer answer(int axis, bool (*seen)(const Trial&), const Asked& asked) const;
  [[nodiscard]] std::vector<Association> of_suspects(int axis) const;
  /// The thruster, or the two together, whose force the residual goes with.
  [[nodiscard]] Association of_thrusters(int axis) const;
  [[nodiscard]] Association step(int axis) const;
  /// What swings slowly in the world, in whatever direction: a few cycles in a run.
  [[nodiscard]] Association swing(int axis) const;
  [[nodiscard]] Association oscillation(int axis) const;
  /// What of the residual neither the base columns nor its own past foretell; empty where that cannot be told, and of
  /// moments beside forces: that of the added mass multiplies the noise of one velocity with another, so its noise
  /// grows with the speed.
  [[nodiscard]] std::vector<std::vector<double>> unforetold_along(int axis) const;
  /// What comes and goes, whatever its sign, and what was measured when it came.
  [[nodiscard]] Association in_bursts(int axis, std::span<const std::vector<double>> left) const;
  /// What came once.
  [[nodiscard]] Association once(int axis, std::span<const std::vector<double>> left) const;
  /// Residual over applied wrench along an axis, both without their means (rms); NaN where none is applied.
  [[nodiscard]] double size(int axis) const;

  const model::Model& model_;
  std::vector<Run> runs_;
  double tried_{};  ///< questions that share the prior
};

}  // namespace fathom::diagnosis
