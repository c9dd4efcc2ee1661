// Does an effect carry over to data that had no part in its size? The direction in which it moves the residuals is
// known; its amplitude is set on some windows and judged on the others.
#pragma once

#include <span>

#include "common/identification/trajectory_fit.hpp"

namespace fathom::diagnosis {

/// Share of the error (RMS) that the effect saves on windows left out when its amplitude was set.
struct HeldOut {
  double blocks{};  ///< left out: a fifth of the 30 s blocks, spread over all runs
  double runs{};    ///< left out: a run at a time; equal to `blocks` with fewer than three runs
  double
      change{};  ///< of the predicted velocity (RMS), share of the measured velocity's, on the axis where it is largest
};

/// `sizes`: the effect's numbers in units of their prior sigma; where the other windows hardly see the effect, this
/// prior keeps the amplitude at zero instead of letting noise set it.
[[nodiscard]] HeldOut held_out(const identification::TrajectoryFit& problem, const identification::FitResult& without,
                               const identification::FitResult& with, std::span<const double> sizes);

}  // namespace fathom::diagnosis
