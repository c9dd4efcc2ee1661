// Along which axes what a model leaves is a random force, for all that can be asked: large enough that structure would
// show, with a memory, and gone with nothing that was recorded. The same is called "adequate" where nothing was found.
#pragma once

#include <array>
#include <span>

#include "common/diagnosis/associations.hpp"
#include "common/samples/diagnosis_result.hpp"

namespace fathom::diagnosis {

/// X..N. `residual` is that of the model, `left` what it goes with, `length` s the data's.
[[nodiscard]] std::array<bool, 6> random_rest(std::span<const AxisWhiteness> residual,
                                              std::span<const Association> left, double length);

}  // namespace fathom::diagnosis
