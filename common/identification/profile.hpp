// Intervals of an effect's inner numbers (times, places, frequencies: what the motion is not proportional to) by
// profile likelihood: how far one of them may go, all others fitted anew, before the fit is significantly worse. The
// two sides may differ, which a standard deviation cannot say (Venzon and Moolgavkar 1988).
#pragma once

#include "common/identification/trajectory_fit.hpp"

namespace fathom::identification {

/// Fills fit.interval95 beside fit.covariance, which must be there: correlation inside windows widens both alike (the
/// rise that counts as significant is that of a Student-distributed number, squared, times the sandwich's variance over
/// the plain one). A side ends at a physical bound when the fit is not significantly worse there; it goes no further
/// than 15 times where a parabola would end.
void add_profiles(const TrajectoryFit& problem, FitResult& fit);

}  // namespace fathom::identification
