// All thrust wrong by one factor, as in another unit than newtons: everything fits, with inertias that no such vehicle
// has.
#pragma once

#include <optional>
#include <span>

#include "common/model/vehicle.hpp"
#include "common/samples/diagnosis_result.hpp"

namespace fathom::preflight {

/// A finding when one factor on all thrust makes the fitted inertias (of `parameters`) those that the vehicle file
/// expects: a hypothesis beside "as filed", by the likelihoods of both and the price and certainty of a wrong thruster.
/// A single inertia that is off is none, nor one that is half or twice what was expected.
[[nodiscard]] std::optional<ConsistencyFinding> compare_inertia(const model::Vehicle& vehicle,
                                                                std::span<const NamedValue> parameters);

}  // namespace fathom::preflight
