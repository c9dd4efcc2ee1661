// From numbers to words: the verdict, each effect's entry, and one paragraph for the engineer at the tank.
#pragma once

#include <span>
#include <string>

#include "common/diagnosis/associations.hpp"
#include "common/diagnosis/search.hpp"

namespace fathom::diagnosis {

/// Share of the residual's variance that must go with something before structure is called unexplained.
constexpr double kSmallestAssociation = 0.1;
/// And its size, share of the applied wrench (rms): what is smaller changes no prediction, as a weak effect (5 %, of
/// which the base model's numbers hide a part) does.
constexpr double kSmallestForce = 0.015;
/// A refused effect that would save this share of the error (RMS) saves it in too few places to be sure of its name,
/// but something is at work: three times what noise with a memory ever let one save on a whole trial. On few windows
/// chance saves more: one window's share is added.
constexpr double kPromising = 0.15;

/// Fills effects, candidates, what was not measured, verdict and paragraph of `result`, whose errors and parameters are
/// already there. `scene` is that of the training runs; `unjudged` says why no prediction was judged, if none was.
void conclude(const SearchResult& found, std::span<const Association> left, const model::Scene& scene,
              DiagnosisResult& result, const std::string& unjudged = "");

}  // namespace fathom::diagnosis
