// Axes along which a model follows its thrust, and those of which it has nothing to tell.
#pragma once

#include <set>
#include <span>
#include <vector>

#include "common/inference/infer.hpp"

namespace fathom::verdict {

/// 0..5: axes on which thrust acts, and of which the model, with its names or without, foretells more of runs that no
/// fit has seen than that nothing changes, and not surely less than an equation of that axis alone. `input_step` [s]:
/// between inputs.
[[nodiscard]] std::vector<int> skilled_axes(const model::Vehicle& vehicle, std::span<const Trial> train,
                                            std::span<const Trial> unseen, double input_step,
                                            const inference::Conclusion& conclusion);

/// 0..5: axes whose numbers mean nothing, for the model does not follow its thrust there. Empty: none.
[[nodiscard]] std::set<int> withheld_axes(const inference::Conclusion& conclusion);

}  // namespace fathom::verdict
