// What a search found and what it refused, as the result tells it: one entry per effect.
#pragma once

#include <cstddef>

#include "common/diagnosis/search.hpp"
#include "common/samples/diagnosis_result.hpp"

namespace fathom::diagnosis {

/// Fills `result.effects` with what was accepted, which stands for `share` of what was lacking; several forms of one
/// effect are one entry.
void list_effects(const SearchResult& found, double share, const model::Scene& scene, DiagnosisResult& result);

/// Fills `result.candidates`, of each effect the best form, those that could not be asked last. How many were asked.
std::size_t list_candidates(const SearchResult& found, const model::Scene& scene, DiagnosisResult& result);

}  // namespace fathom::diagnosis
