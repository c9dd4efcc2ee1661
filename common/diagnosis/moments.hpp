// Moments have many local optima: a failing thruster that happens to rest looks the same whether it fails before or
// after its rest. A fit that walks downhill from where it began may end in the wrong one.
#pragma once

#include "common/identification/trajectory_fit.hpp"
#include "common/model/effect.hpp"

namespace fathom::diagnosis {

/// The fit, or a better one that begins with the effect's onset elsewhere in the data. Effects without an onset are
/// returned as they are.
[[nodiscard]] identification::FitResult at_best_moment(const identification::TrajectoryFit& problem,
                                                       identification::FitResult fit, const model::Effect& effect,
                                                       int variant);

}  // namespace fathom::diagnosis
