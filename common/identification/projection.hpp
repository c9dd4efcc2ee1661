// Sign constraints on an estimate, by the nearest admissible point in the metric of its covariance.
#pragma once

#include <array>
#include <cstdint>

#include "common/identification/rows.hpp"

namespace fathom::identification {

using Signs = std::array<std::int8_t, kMaxParameters>;  ///< +1, -1 or 0 (free) per parameter

/// Whether x obeys the signs (zero does).
[[nodiscard]] bool obeys(const ParameterVector& x, const Signs& signs);

/// argmin (x - x_hat)' P^-1 (x - x_hat) subject to the signs. P must be positive definite.
[[nodiscard]] ParameterVector project_on_signs(const ParameterVector& x_hat, const ParameterMatrix& P,
                                               const Signs& signs);

}  // namespace fathom::identification
