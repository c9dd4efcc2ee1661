// An answer of `fathom diagnose` as EFFECTS says it.
#pragma once

#include "common/live/background_search.hpp"
#include "common/verdict/by_likelihood.hpp"

namespace fathom::live {

/// The verdict in the same word; candidates with their odds, accepted ones first. What only stands in for something
/// that no list holds is no candidate (docs/decisions/194). Without its time.
[[nodiscard]] EffectRanking ranking_of(const verdict::Answer& answer);

/// What was learned beside the listed effects, or why not; nothing where they explain all. Without its time.
[[nodiscard]] std::optional<LearnedTold> learned_of(const verdict::Answer& answer);

/// Of two that the data cannot tell apart, where a motion could: none of a sensor's, nor of a column's.
[[nodiscard]] Rivals rivals_of(const verdict::Answer& answer);

}  // namespace fathom::live
