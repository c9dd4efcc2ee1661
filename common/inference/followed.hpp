// How much of a motion's acceleration a model foretells.
#pragma once

#include <vector>

#include "common/inference/scan.hpp"

namespace fathom::inference {

/// Per simulated axis, the share of the acceleration that the model foretells. Below zero: it had better foretell none.
[[nodiscard]] std::vector<double> followed(const likelihood::Problem& problem, const Seen& seen);

}  // namespace fathom::inference
