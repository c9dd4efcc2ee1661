// What a model's predictions are worth beside the simplest ones: that nothing changes, and an equation per axis that
// knows nothing of the other axes.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "common/residual/prediction.hpp"
#include "common/samples/verdict_given.hpp"

namespace fathom::verdict {

constexpr std::size_t kFiveSeconds = 1;  ///< place among residual::kHorizons: the horizon at which models are judged

/// nu_dot = input tau + linear nu + quadratic |nu| nu + constant, of one axis by itself.
struct PlainAxis {
  double input{}, linear{}, quadratic{}, constant{};  ///< SI; input: m/s^2 per N, rad/s^2 per N m
  /// Student's t of `input`: between -3 and 3 or so the input does not act. Of an equation that also knows what rights
  /// a tilted craft: else a trim that holds it, against its weight, would seem to push backward.
  double t_of_input{};
  bool known{};
};

/// Least squares on accelerations over a quarter of a second, or from one measurement to the next where they are
/// farther apart, per simulated axis.
[[nodiscard]] std::array<PlainAxis, 6> plain_fit(const model::Vehicle& vehicle, std::span<const Trial> trials);

/// Errors over prediction windows where nothing changes, and by the plain fit.
[[nodiscard]] residual::Predictions predict_unchanged(std::span<const model::Window> windows);
[[nodiscard]] residual::Predictions predict_plainly(const model::Vehicle& vehicle,
                                                    const std::array<PlainAxis, 6>& plain,
                                                    std::span<const model::Window> windows);

/// 1 - (error / error of the simpler prediction)^2 per horizon and axis: above 0, the model is better.
[[nodiscard]] std::vector<SkillGiven> skill_of(const model::Vehicle& vehicle, const residual::Predictions& model,
                                               const residual::Predictions& unchanged,
                                               const residual::Predictions& plain);

/// P-value, one-sided over windows, of a model that is no worse than `simpler` showing errors as much larger.
[[nodiscard]] double p_no_worse(const residual::Predictions& model, const residual::Predictions& simpler,
                                std::size_t horizon, std::size_t axis);

/// Of one axis over all windows; below zero: nothing was measured.
[[nodiscard]] double mean_square(const residual::Predictions& predictions, std::size_t horizon, std::size_t axis);

}  // namespace fathom::verdict
