// Intervals of effects' numbers by profile likelihood: how far one of them may go, all others fitted anew, before the
// fit is significantly worse. The two sides may differ, which a standard deviation cannot say (Venzon and Moolgavkar
// 1988). Numbers that an effect names as its amplitudes need none: the motion is all but proportional to them.
#pragma once

#include "common/identification/trajectory_fit.hpp"

namespace fathom::identification {

/// Fills fit.interval95 beside fit.covariance, which must be there. Correlation inside windows widens both alike: the
/// rise that counts as significant is half of Student's quantile, squared, times the sandwich's variance over the plain
/// one. A side ends at a physical bound when the fit is not significantly worse there; it goes no further than 15 times
/// where a parabola would end.
void add_profiles(const TrajectoryFit& problem, FitResult& fit);

}  // namespace fathom::identification
