// Open-loop errors of two models on the same stretches, window by window, so that one chaotic window decides nothing.
#pragma once

#include <span>
#include <vector>

#include "common/model/rollout.hpp"

namespace fathom::residual {

struct OpenLoop {
  double horizon{10.0};       ///< s
  double shortest{1.0};       ///< s of a horizon that is cut
  double growth{5.0};         ///< of a small change of the start, beyond which a motion counts as chaotic
  double start_change{1e-3};  ///< of the velocities' rms
};

struct Compared {
  std::vector<double> log_ratio;  ///< per window: of the other model's error to the base model's
  int shortened{};                ///< windows whose horizon was cut
};

/// Errors are root mean squares over the axes, each over its velocity's rms. A window is cut where a change of its
/// start grows by `how.growth` in either model, and left out where that happens within `how.shortest`.
void compare(const model::Model& base, const model::Model& other, std::span<const model::Window> windows,
             const OpenLoop& how, Compared& compared);

/// Windows of `how.horizon` side by side within [from, to) s of a trial, each begun where all is measured.
[[nodiscard]] std::vector<model::Window> windows_within(const Trial& trial, double from, double to,
                                                        const OpenLoop& how);

/// Windows as far as a motion can be foretold from a measured start.
struct Foreseen {
  std::vector<model::Window> windows;
  int cut{};         ///< of them
  double typical{};  ///< s, the middle one of those lengths; 0: none was cut
};

/// Each window to where a small change of its start has grown by `how.growth` in one of the models, `how.shortest` at
/// least: who errs more behind that has begun elsewhere, and need not be wrong.
[[nodiscard]] Foreseen foreseen(std::span<const model::Window> windows, std::span<const model::Model* const> models,
                                const OpenLoop& how = {});

/// Mean over windows with its standard error, as a ratio of errors.
struct Ratio {
  double value{1.0};
  double log_error{};  ///< standard error of its logarithm
  int windows{};
};
[[nodiscard]] Ratio ratio_of(const Compared& compared);
/// Of the other model's errors to the base model's, over whole trials.
[[nodiscard]] Ratio error_over(const model::Model& base, const model::Model& other, std::span<const Trial> trials,
                               const OpenLoop& how);

}  // namespace fathom::residual
