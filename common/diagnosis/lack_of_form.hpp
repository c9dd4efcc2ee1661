// Does a named effect have the right form? Something that no list holds is imitated by what the list holds: a layer of
// dense water by a bottom that is felt near it. Beside a true effect a free curve over a measured quantity has nothing
// to do; beside an imitation it still helps, with what by itself it would explain in the imitation's place.
#pragma once

#include "common/diagnosis/search.hpp"

namespace fathom::diagnosis {

/// Moves accepted effects that a free curve shows to be imitations to the refused ones, and says which curve would
/// still help on data left out of its estimate (`free_form`). `accepted`: the fit of the accepted effects to `problem`.
/// True when any was moved; the model is then to be fitted again without them.
[[nodiscard]] bool test_forms(SearchResult& result, const identification::TrajectoryFit& problem,
                              const identification::FitResult& accepted, const model::Scene& scene,
                              const Progress& progress);

}  // namespace fathom::diagnosis
