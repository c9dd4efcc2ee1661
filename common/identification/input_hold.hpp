// How commands act between their samples: held until the next one, along straight lines, or told afterwards. Logs do
// not say. The motion does, to a few milliseconds, and a model that assumes it wrongly sees a delay that is none.
#pragma once

#include "common/identification/trajectory_fit.hpp"

namespace fathom::identification {

/// Model::input_hold that fits best beside all free numbers, from -1/2 to 1/2, by one Gauss-Newton step from `fit`.
/// Where an effect is a time after the command as well, that of the fit's model unless another fits clearly better: a
/// delay cannot be told from a hold, a lag can, by its shape.
[[nodiscard]] double input_hold(const TrajectoryFit& problem, const FitResult& fit);

/// The fit with the hold that fits it best, near the one it has.
[[nodiscard]] FitResult with_input_hold(const TrajectoryFit& problem, FitResult fit);

}  // namespace fathom::identification
