#include "test/sealed/judging/rate.hpp"

#include <algorithm>
#include <cmath>

namespace fathom::sealed {

Rate wilson(long part, long whole) {
  if (whole <= 0) return {};
  constexpr double z = 1.959964;  // of 95 %
  const double n = static_cast<double>(whole), p = static_cast<double>(part) / n;
  const double middle = (p + z * z / (2.0 * n)) / (1.0 + z * z / n);
  const double half = z / (1.0 + z * z / n) * std::sqrt(p * (1.0 - p) / n + z * z / (4.0 * n * n));
  return {p, std::max(0.0, middle - half), std::min(1.0, middle + half)};
}

}  // namespace fathom::sealed
