// A learned force as it is told: names and numbers of a result back to what the model reads.
#pragma once

#include <optional>
#include <string>

#include "common/model/learned/features.hpp"
#include "common/samples/correction.hpp"

namespace fathom::model {

/// None where it names a quantity that is not known.
[[nodiscard]] std::optional<Factor> factor_of(const CorrectionFactor& told);
/// None where it names a quantity that is not known, or has too many factors.
[[nodiscard]] std::optional<Feature> feature_of(const CorrectionTerm& term);
/// Of a law that has a place: "point at N 1 m, E 2 m"; others: empty.
[[nodiscard]] std::string where(const CorrectionTerm& term);

}  // namespace fathom::model
