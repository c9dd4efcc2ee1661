// Rates with the interval that so many sets leave open.
#pragma once

#include "test/sealed/judging/judge.hpp"

namespace fathom::sealed {

/// A share and its 95 % interval.
struct Rate {
  double share{kUnknown}, low{0.0}, high{1.0};
};
/// Score interval of a binomial share (Wilson 1927): within 0 and 1 and honest where all or none came.
[[nodiscard]] Rate wilson(long part, long whole);

}  // namespace fathom::sealed
