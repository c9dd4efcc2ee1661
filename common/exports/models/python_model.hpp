// The model as a function of numpy, for the formats that are Python.
#pragma once

#include <string>

#include "common/exports/models/craft.hpp"

namespace fathom::exports {

/// Constants and `body_acceleration(R, nu, tau)`: body forward-right-down, `R` to north-east-down.
[[nodiscard]] std::string python_model(const Craft& craft);

}  // namespace fathom::exports
