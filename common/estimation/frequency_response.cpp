#include "common/estimation/frequency_response.hpp"

#include <numbers>

namespace fathom::estimation {

// x- = x + dt r and r as before; then x += value e and r += rate e of e = z - x-. With q one sample's delay:
// r = rate e / (1 - q), x- (1 - q) = q (value + dt rate / (1 - q)) e, and x = x- + value e.
std::complex<double> frequency_response(const Gains& gains, double dt, double frequency) {
  const std::complex<double> q = std::polar(1.0, -2.0 * std::numbers::pi * frequency * dt);
  const std::complex<double> sum = 1.0 / (1.0 - q);
  const std::complex<double> before = q * sum * (gains.value + dt * gains.rate * sum);
  return (before + gains.value) / (before + 1.0);
}

}  // namespace fathom::estimation
