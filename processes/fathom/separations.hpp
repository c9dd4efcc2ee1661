// After a diagnosis that stayed ambiguous: which segment, inside the site's fence, would tell the look-alikes apart.
#pragma once

#include <span>
#include <string>

#include "common/identification/trajectory_fit.hpp"
#include "common/planning/rehearsal.hpp"
#include "common/samples/diagnosis_result.hpp"

namespace fathom::tool {

/// Fills `told_apart` of every effect with alternatives, and the manoeuvre that the report proposes. `train` and `fit`:
/// what the effects were found in.
void separate(const model::Vehicle& vehicle, const planning::RehearsalSettings& settings, std::span<const Trial> train,
              const identification::FitResult& fit, DiagnosisResult& result);

}  // namespace fathom::tool
