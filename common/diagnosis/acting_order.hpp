// A dead band before a lag is not one behind it, and no rule says which of the two a thruster has: the data is asked.
#pragma once

#include "common/diagnosis/search.hpp"
#include "common/identification/trajectory_fit.hpp"

namespace fathom::diagnosis {

/// Whether that form of the effect acts on the thrust that others leave (ActiveEffect::last): not where there are none.
[[nodiscard]] bool acts_last(const model::Model& model, const Judged& judged);

/// Fits the accepted effects whose place among those that change the thrust matters at the other end of them, and keeps
/// what is clearly better.
void reconsider_order(SearchResult& result, const identification::TrajectoryFit& problem, const Progress& progress,
                      double done);

}  // namespace fathom::diagnosis
