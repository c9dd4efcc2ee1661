// The moment from which on a term acts: cumulated sums of one column's slope tell roughly where it is, all columns of
// its group together tell exactly.
#pragma once

#include "common/inference/feature_screen.hpp"

namespace fathom::learning {

/// It acts from a moment on.
[[nodiscard]] bool sets_in(const model::Feature& feature);

/// Moments of these groups where their own evidence is largest: first all over the recordings, then about the best.
/// Groups without a moment stay what they are. The log Bayes factors of those that have one, prices not paid, by group.
[[nodiscard]] std::vector<std::pair<std::size_t, double>> profile_moments(const likelihood::Problem& problem,
                                                                          const inference::Seen& seen,
                                                                          const std::vector<std::size_t>& groups,
                                                                          likelihood::FreeForce& library, int threads);

}  // namespace fathom::learning
