// Where fits of what is proposed begin.
#pragma once

#include <vector>

#include "common/inference/fitted_models.hpp"

namespace fathom::inference {

/// `from` with these effects. A promise is linear: where the motion is not, or what is asked is nearly one of the base
/// numbers, it can lie so far off that the filter loses the measured motion, and no step leads back. Then the effects'
/// linear numbers (those of `laws`) are made smaller until it does not.
[[nodiscard]] Start start_of(const likelihood::Problem& problem, const std::vector<Law>& laws,
                             const likelihood::Hypothesis& from, const std::vector<model::ActiveEffect>& added,
                             const likelihood::Noise& noise);

}  // namespace fathom::inference
