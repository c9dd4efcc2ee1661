// What this deputy's programs find in their environment.
#pragma once

#include <string>

namespace fathom::deputy {

/// Own folder first in PATH; FATHOM_SHARE, FATHOM_RUN, FATHOM_OPERATOR, FATHOM_VEHICLE and LCM_DEFAULT_URL where they
/// are not set (see procman/environment).
void set_environment();

/// Value of a variable; empty when it is not set.
[[nodiscard]] std::string variable(const char* name);

}  // namespace fathom::deputy
