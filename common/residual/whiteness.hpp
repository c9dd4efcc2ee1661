// Is a residual white, and how long is its memory?
#pragma once

#include <span>
#include <vector>

#include "common/base/spatial.hpp"
#include "common/model/dynamics.hpp"
#include "common/samples/diagnosis_result.hpp"
#include "common/samples/trial.hpp"

namespace fathom::residual {

/// Autocorrelation of a series at lags 0..most; NaN samples are skipped, gaps respected.
[[nodiscard]] std::vector<double> autocorrelation(std::span<const double> series, std::size_t most);
/// Period, s, of a series that swings: after a trough its autocorrelation has a crest, about twice as late, both beyond
/// what chance leaves of `count` samples (Bartlett 1946). NaN where it does not swing. `step` [s] from lag to lag.
[[nodiscard]] double swing_period(std::span<const double> rho, double step, double count);
/// P-value of Ljung and Box's portmanteau test over `rho[1..]` of a series with `count` samples (1978, eq. 2.5).
[[nodiscard]] double ljung_box_p(std::span<const double> rho, double count);

/// Whiteness, memory, swing and explained share of the wrench residual, per simulated axis on which there is one.
[[nodiscard]] std::vector<AxisWhiteness> whiteness(const model::Model& model, std::span<const Trial> trials,
                                                   std::span<const std::vector<Vector6d>> residuals);

}  // namespace fathom::residual
