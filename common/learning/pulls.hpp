// Pulls toward a point of the world, as of a line that is slack up to a length: where the search of point and length
// begins, and where the seen model's filter, linear in the rest, likes them best.
#pragma once

#include <utility>
#include <vector>

#include "common/inference/feature_screen.hpp"

namespace fathom::learning {

/// Half of the diagonal of where it was, m; not nothing.
[[nodiscard]] double reach_of(const model::Scene& scene);

/// Middle, and all around within and beyond where it was; slack nowhere, in a part of it, or nearly everywhere.
[[nodiscard]] std::vector<model::Factor> stretches_of(const model::Scene& scene);

/// The factor that holds point and length; none: the feature is no pull.
template <typename Of>
[[nodiscard]] auto stretch_in(Of& feature) -> decltype(feature.factors.data()) {
  for (int i = 0; feature.pulls() && i < feature.count; ++i) {
    auto& factor = feature.factors[static_cast<std::size_t>(i)];
    if (factor.quantity == model::Quantity::kStretch) return &factor;
  }
  return nullptr;
}

/// The part of N, E, D and length, by its number.
[[nodiscard]] double& number_of(model::Factor& stretch, std::size_t i);
constexpr std::size_t kNumbersOfStretch = 4;

/// Of these groups of the library those that are pulls are moved to where they are most likely, beside the seen model
/// and nothing else. Each with its log Bayes factor there, its price unpaid.
[[nodiscard]] std::vector<std::pair<std::size_t, double>> profile_pulls(const likelihood::Problem& problem,
                                                                        const inference::Seen& seen,
                                                                        const model::Scene& scene,
                                                                        const std::vector<std::size_t>& groups,
                                                                        likelihood::FreeForce& library, int threads);

}  // namespace fathom::learning
