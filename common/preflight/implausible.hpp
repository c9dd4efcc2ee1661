// Fitted numbers that no craft of the file's size has, said beside them: a model may predict well and mean nothing.
#pragma once

#include <span>
#include <vector>

#include "common/model/vehicle.hpp"
#include "common/samples/diagnosis_result.hpp"

namespace fathom::preflight {

/// A finding per parameter that is out of the range of physics by more than two of its standard deviations: a mass with
/// added water below the craft's own (and what its file expects) or beyond any hull's, a moment of inertia, quadratic
/// drag. Empty where the file states no mass.
[[nodiscard]] std::vector<ConsistencyFinding> implausible_numbers(const model::Vehicle& vehicle,
                                                                  std::span<const NamedValue> parameters);

}  // namespace fathom::preflight
