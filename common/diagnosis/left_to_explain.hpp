// Whether a fit leaves anything that a missing effect could explain. Whatever acts on a vehicle passes through its
// inertia: what a model lacks lasts, noise does not.
#pragma once

#include "common/identification/trajectory_fit.hpp"

namespace fathom::diagnosis {

/// Upper end (two standard deviations) of the share of the fit's cost that lasts for two seconds and more, beyond what
/// noise as strong as between half a second and two would leave there: what short windows do not see. 1 where the data
/// are sampled too rarely to tell.
[[nodiscard]] double left_to_explain(const identification::TrajectoryFit& problem,
                                     const identification::FitResult& fit);

}  // namespace fathom::diagnosis
