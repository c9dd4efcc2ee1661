// Products of powers, of which series about a motion ahead are made: of ships, in surge, sway and yaw.
#pragma once

#include <cmath>

#include "common/model/manoeuvring/manoeuvring_terms.hpp"

namespace fathom::model {

template <int n>
[[nodiscard]] double power(double x) {
  double product = 1.0;
  for (int i = 0; i < n; ++i) product *= x;
  return product;
}

/// U^2 (du/U)^a (v/U)^b (r/U)^c d^e, du = u - U_0; r L/U has its L among the powers of the length. 0 at rest.
template <int a, int b, int c, int e>
[[nodiscard]] double of_series(const TermMotion& n) {
  constexpr double kNoFlow = 1e-9;  // m/s: no speed to divide by
  constexpr int kOrder = a + b + c, kTimes = kOrder < 2 ? 2 - kOrder : 0, kOver = kOrder > 2 ? kOrder - 2 : 0;
  const double U = std::hypot(n[0], n[1]);
  if (U < kNoFlow) return 0.0;
  return power<a>(n[0] - n.cruise) * power<b>(n[1]) * power<c>(n[5]) * power<e>(n.rudder) * power<kTimes>(U) /
         power<kOver>(U);
}

/// Along surge, sway (two powers of the length) or about yaw (three), one more for each r.
template <int a, int b, int c, int e>
[[nodiscard]] constexpr ManoeuvringTerm series_term(std::string_view name, int axis, TermScale scale) {
  return {.name = name,
          .axis = axis,
          .power = (axis == 5 ? 3 : 2) + c,
          .value = of_series<a, b, c, e>,
          .scale = scale,
          .steers = e > 0};
}

}  // namespace fathom::model
