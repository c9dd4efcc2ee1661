// What the search accepted one by one is tested again together, on all data.
#pragma once

#include "common/diagnosis/search.hpp"
#include "common/identification/trajectory_fit.hpp"

namespace fathom::diagnosis {

/// Drops every accepted effect that the others have made superfluous, as they are or in another form, or that all data
/// does not bear out; fills in the final odds of those that stay. `tried`: candidates that share the prior.
void prune(SearchResult& result, const identification::TrajectoryFit& problem, const model::Scene& scene,
           const Settings& settings, int tried, const Progress& progress);

}  // namespace fathom::diagnosis
