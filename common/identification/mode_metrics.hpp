// How sure the parameters of each motion are (Karras et al., eq. 1.15).
#pragma once

#include <vector>

#include "common/identification/rows.hpp"
#include "common/model/parameters.hpp"
#include "common/samples/estimates.hpp"

namespace fathom::identification {

/// One for each axis that has parameters, then "total". Sums are of `variance`, in mixed units; beside them stands the
/// largest `sigma` over its parameter's size.
[[nodiscard]] std::vector<ModeMetric> mode_metrics(const std::vector<model::BaseParameter>& parameters,
                                                   const ParameterVector& variance, const ParameterVector& estimate,
                                                   const ParameterVector& sigma);

}  // namespace fathom::identification
