#include "common/base/entanglement.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <limits>

namespace fathom {

TEST_CASE("entanglement: two parameters by hand, whatever their units") {
  // Correlation r: inflation 1 / (1 - r^2), eigenvalues 1 + r and 1 - r.
  constexpr double kR = 0.8;
  for (const double unit : {1.0, 1e-3, 1e4}) {
    const double s = 2.0 * unit;
    const Entanglement found = entanglement(std::array{9.0, kR * 3.0 * s, kR * 3.0 * s, s * s});
    REQUIRE(found.inflation.size() == 2);
    CHECK(found.inflation[0] == doctest::Approx(1.0 / (1.0 - kR * kR)));
    CHECK(found.inflation[1] == doctest::Approx(1.0 / (1.0 - kR * kR)));
    CHECK(found.condition == doctest::Approx(9.0));
  }
}

TEST_CASE("entanglement: an independent one stays at 1 beside two that are hardly told apart") {
  const Entanglement found = entanglement(std::array{4.0, 0.0, 0.0, 0.0, 1.0, 0.9999, 0.0, 0.9999, 1.0});
  REQUIRE(found.inflation.size() == 3);
  CHECK(found.inflation[0] == doctest::Approx(1.0));
  CHECK(found.inflation[1] > 4999.0);
  CHECK(found.condition > 19'000.0);
}

TEST_CASE("entanglement: what is no covariance has none") {
  constexpr double kNot = std::numeric_limits<double>::quiet_NaN();
  CHECK(entanglement({}).inflation.empty());
  CHECK(entanglement(std::array{1.0, 0.0, 0.0}).inflation.empty());       // not square
  CHECK(entanglement(std::array{1.0, 1.0, 1.0, 1.0}).inflation.empty());  // one combination not known at all
  CHECK(entanglement(std::array{1.0, kNot, kNot, 1.0}).inflation.empty());
  CHECK(entanglement(std::array{1.0, 0.0, 0.0, 0.0}).condition == 0.0);
}

}  // namespace fathom
