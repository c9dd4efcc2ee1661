// Groups of a library moved to where their inner numbers are most likely, beside a seen model and nothing else.
#pragma once

#include <utility>
#include <vector>

#include "common/inference/feature_screen.hpp"
#include "common/learning/room.hpp"

namespace fathom::learning {

/// Each of these groups, whose features share a factor with inner numbers, with its log Bayes factor there, its price
/// unpaid: Gauss-Newton in the seen model's filter, on weights and inner numbers together.
[[nodiscard]] std::vector<std::pair<std::size_t, double>> profile_inner(const likelihood::Problem& problem,
                                                                        const inference::Seen& seen,
                                                                        const model::Scene& scene, const Room& room,
                                                                        const std::vector<std::size_t>& groups,
                                                                        likelihood::FreeForce& library, int threads);

}  // namespace fathom::learning
