#include "common/base/distributions.hpp"

#include <doctest/doctest.h>

#include <initializer_list>

namespace fathom {

TEST_CASE("F: tail probabilities and quantiles of the tables") {
  constexpr double kTable = 5e-3;  // tables have three digits
  CHECK(f_tail(4.96, 10) == doctest::Approx(0.05).epsilon(kTable));
  CHECK(f_tail(6.63, 1e6) == doctest::Approx(0.01).epsilon(kTable));
  CHECK(f_quantile(0.05, 20) == doctest::Approx(4.351).epsilon(kTable));
  CHECK(f_tail(0.0, 5) == 1.0);
}

TEST_CASE("Student: the quick widening is that of the quantile") {
  constexpr double kGaussian = 1.959964 * 1.959964;
  for (const double freedom : {3.0, 4.5, 8.0, 20.0, 100.0, 1e5}) {
    CAPTURE(freedom);
    CHECK(student_widening(freedom) == doctest::Approx(f_quantile(0.05, freedom) / kGaussian).epsilon(0.01));
  }
}

TEST_CASE("incomplete beta: closed forms and symmetry") {
  constexpr double kRounding = 1e-12;
  CHECK(incomplete_beta(0.3, 1.0, 1.0) == doctest::Approx(0.3).epsilon(kRounding));
  CHECK(incomplete_beta(0.3, 2.0, 1.0) == doctest::Approx(0.09).epsilon(kRounding));
  CHECK(incomplete_beta(0.2, 7.0, 0.5) == doctest::Approx(1.0 - incomplete_beta(0.8, 0.5, 7.0)).epsilon(kRounding));
}

}  // namespace fathom
