// What was accepted first was accepted while the others still acted unknown. Beside them another form of it, which
// looked alike then (the other thruster of a pair), may be the true one.
#pragma once

#include "common/diagnosis/search.hpp"
#include "common/identification/trajectory_fit.hpp"

namespace fathom::diagnosis {

/// Fits the forms that an accepted effect could not be told from in its place, the last accepted one apart, and keeps
/// the best; forms that are then clearly worse or better leave the list of those that remain open.
void reconsider_forms(SearchResult& result, const identification::TrajectoryFit& problem, const model::Scene& scene,
                      const Progress& progress, double done);

}  // namespace fathom::diagnosis
