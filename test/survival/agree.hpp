// Whether what two trials have learnt is the same, as far as both say how well they know it.
#pragma once

#include <doctest/doctest.h>

#include <cmath>

#include "common/samples/estimates.hpp"

namespace fathom::test {

/// Two runs share no noise: each difference counts against what both say of their doubt. Of thirteen that are normal
/// one in 1200 is beyond this.
inline constexpr double kFar = 4.0;

/// `share` of a value may come on top: of errors that a trial does not know of.
inline void check_agree(const ModelEstimate& a, const ModelEstimate& b, double share = 0.0) {
  REQUIRE(a.parameters.size() == b.parameters.size());
  double sum = 0.0;
  for (std::size_t i = 0; i < a.parameters.size(); ++i) {
    const NamedValue &x = a.parameters[i], &y = b.parameters[i];
    const double far = (x.value - y.value) / std::hypot(x.std, y.std);
    const double allowed = kFar + share * std::abs(y.value) / std::hypot(x.std, y.std);
    CHECK_MESSAGE(std::abs(far) < allowed,
                  x.name << ": " << x.value << " ± " << x.std << ", " << y.value << " ± " << y.std);
    sum += far * far;
  }
  MESSAGE("parameters differ by " << std::sqrt(sum / static_cast<double>(a.parameters.size()))
                                  << " standard deviations (rms of " << a.parameters.size() << ")");
}

}  // namespace fathom::test
