// Open-loop prediction on validation runs: how far off a model is 1, 5 and 10 s after it last saw a measurement.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "common/model/rollout.hpp"
#include "common/samples/diagnosis_result.hpp"

namespace fathom::residual {

constexpr std::array<double, 3> kHorizons{1.0, 5.0, 10.0};  // s

/// Squared errors of one prediction window.
struct WindowErrors {
  std::array<std::array<double, 6>, 3> square{};  ///< per horizon and axis, summed over (0, horizon]
  std::array<std::array<double, 6>, 3> count{};
};

/// Prediction errors of one model on a set of windows, and what R2 is measured against.
struct Predictions {
  std::vector<WindowErrors> windows;
  std::array<std::array<double, 6>, 3> variance{};  ///< of the measured velocity over the same samples
  std::array<double, 6> noise{};                    ///< variance of the sensors' noise in it

  [[nodiscard]] std::vector<PredictionError> summary(const model::Vehicle& vehicle) const;
  /// P-value of the model's foretelling `share` of the motion or more, by how its error scatters from window to window
  /// (Student's t, one-sided). Noise costs a prediction twice: where it begins and where it is compared.
  [[nodiscard]] double p_foretells(double share, std::size_t horizon, std::size_t axis) const;
};

/// True where the velocity of an axis at sample `k` is a measurement, not a guess across a gap.
[[nodiscard]] bool is_measured(const Trial& trial, std::size_t k, std::size_t axis);

/// Windows of 10 s whose starts follow one another every 5 s, each beginning at a valid sample, `lead` s or more after
/// its run's beginning, where that leaves a run a window.
[[nodiscard]] std::vector<model::Window> prediction_windows(std::span<const Trial> trials, double lead = 0.0);
/// How long before a window a model must have seen the motion to remember what it should, s: what was cut out of a
/// longer run does not begin at rest.
[[nodiscard]] double lead_of(const model::Model& model);
[[nodiscard]] Predictions predict(const model::Model& model, std::span<const model::Window> windows);

/// Starts of predictions of 10 s, one after the other; each waits for a sample at which all that is observed is valid.
[[nodiscard]] std::vector<std::size_t> restarts(const Trial& trial);
/// Velocities u v w p q r over the whole trial, begun anew at the measured velocity of each start and followed for 10 s
/// at most; NaN in between and where an axis is not simulated.
[[nodiscard]] std::vector<std::array<double, 6>> predict_anew(const model::Model& model, const Trial& trial,
                                                              std::span<const std::size_t> starts);

/// Fall of the normalised 5 s error (mean over axes of RMSE over the measured standard deviation) from `before` to
/// `after`, relative to before, with a 95 % interval by bootstrap over blocks of windows (seeded: repeatable).
[[nodiscard]] Interval improvement(const Predictions& before, const Predictions& after, const model::Vehicle& vehicle);

}  // namespace fathom::residual
