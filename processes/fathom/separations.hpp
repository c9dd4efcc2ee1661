// After a diagnosis that stayed ambiguous: which segment, inside the site's fence, would tell the look-alikes apart.
#pragma once

#include <span>
#include <string>

#include "common/planning/rehearsal.hpp"
#include "common/samples/diagnosis_result.hpp"

namespace fathom::tool {

/// Fills `told_apart` of every effect with alternatives, and the manoeuvre that the report proposes. `train`, `best`:
/// the runs that the effects were found in, and the model with them.
void separate(const model::Vehicle& vehicle, const planning::RehearsalSettings& settings, std::span<const Trial> train,
              const model::Model& best, DiagnosisResult& result);

}  // namespace fathom::tool
