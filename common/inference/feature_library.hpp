// What a free force may run over: groups of smooth functions, one kind and one axis each, scaled to the applied wrench.
#pragma once

#include "common/inference/scan.hpp"

namespace fathom::inference {

/// Library of a seen model. Own linear and quadratic drag and own thrust are left out: base numbers hold them.
[[nodiscard]] likelihood::FreeForce feature_library(const likelihood::Problem& problem, const Seen& seen,
                                                    const model::Scene& scene);

/// Base numbers hold this component of the lever of weight and buoyancy, 0..2.
[[nodiscard]] bool base_has_lever(const std::vector<likelihood::Number>& numbers, int component);
/// Components of the lever of weight and buoyancy that are felt where these axes move.
[[nodiscard]] std::vector<int> levers_that_turn(const std::vector<int>& axes);

}  // namespace fathom::inference
