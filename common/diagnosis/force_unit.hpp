// Thrust in another unit than newtons: everything fits, with inertias that no such vehicle has.
#pragma once

#include <optional>
#include <span>

#include "common/model/vehicle.hpp"
#include "common/samples/diagnosis_result.hpp"

namespace fathom::diagnosis {

/// A finding when the fitted inertias (of `parameters`) are, by their median, a fifth or fivefold of what the
/// vehicle file expects, or further off.
[[nodiscard]] std::optional<ConsistencyFinding> compare_inertia(const model::Vehicle& vehicle,
                                                                std::span<const NamedValue> parameters);

}  // namespace fathom::diagnosis
