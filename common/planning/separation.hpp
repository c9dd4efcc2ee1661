// After a trial: which segment would tell an effect that was found from one that explains the same as well?
#pragma once

#include "common/planning/energies.hpp"

namespace fathom::planning {

/// `data`: the trial, with the model that was fitted to it less the effect. The other effect is taken in the form and
/// at the size in which it does most nearly what `found` does. Empty when no segment would tell them apart, or the data
/// already does.
[[nodiscard]] std::optional<Answer> segment_between(const model::ActiveEffect& found, const model::Effect& other,
                                                    const model::Scene& scene, const View& data,
                                                    std::span<const Extra> extras);

}  // namespace fathom::planning
