// Two estimates of the same numbers, of which one knows more: may it replace the other, and what becomes of intervals.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "common/identification/trajectory_fit.hpp"

namespace fathom::identification {

/// Hausman's question (1978, Econometrica 46), number by number: an efficient estimate lies where the other one, which
/// has its covariance, may lie by chance. `by_more` has the same effects.
[[nodiscard]] bool agree(const FitResult& by_fewer, const model::Model& by_more);

/// Ends of intervals that a profile found of the first, drawn in as standard deviations became smaller. Where the cost
/// is no parabola (it is flat while a failing thruster rests) an end says what a deviation cannot, and stays.
[[nodiscard]] std::vector<std::optional<std::array<double, 2>>> drawn_in(const FitResult& by_fewer,
                                                                         const FitResult& by_more);

}  // namespace fathom::identification
