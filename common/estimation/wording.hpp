// Numbers in the sentences of findings.
#pragma once

#include <string>

namespace fathom::estimation {

/// As printf, for doubles: %.3g and its like, six at most.
[[nodiscard]] std::string text(const char* format, double a, double b = 0.0, double c = 0.0, double d = 0.0,
                               double e = 0.0, double f = 0.0);

}  // namespace fathom::estimation
