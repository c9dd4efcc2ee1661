#include "common/likelihood/transition.hpp"

#include <doctest/doctest.h>

#include <cmath>

using fathom::likelihood::Transition;

TEST_CASE("transition: a scalar decays exactly, however stiff") {
  for (const double x : {1e-6, 0.05, 0.7, 2.5, 8.0, 40.0}) {
    const Eigen::Matrix<double, 1, 1> A{-x};
    const Transition<1> step{A, 1.0};
    CHECK(step.E(0, 0) == doctest::Approx(std::exp(-x)).epsilon(1e-6));
    CHECK(step.Gamma(0, 0) == doctest::Approx(-std::expm1(-x) / x).epsilon(1e-7));
  }
}

TEST_CASE("transition: a turning system turns") {
  Eigen::Matrix2d A;
  A << 0.0, -2.0, 2.0, 0.0;
  const Transition<2> step{A, 0.6};
  CHECK(step.E(0, 0) == doctest::Approx(std::cos(1.2)).epsilon(1e-8));
  CHECK(step.E(1, 0) == doctest::Approx(std::sin(1.2)).epsilon(1e-8));
  CHECK(step.Gamma(0, 0) == doctest::Approx(std::sin(1.2) / 2.0).epsilon(1e-8));
  CHECK(step.Gamma(1, 0) == doctest::Approx((1.0 - std::cos(1.2)) / 2.0).epsilon(1e-8));
}
