#include "common/base/distributions.hpp"

#include <cmath>

namespace fathom {
namespace {

/// Continued fraction of I_x(a, b), modified Lentz; quick where x < (a + 1) / (a + b + 2).
double beta_fraction(double x, double a, double b) {
  constexpr double kTiny = 1e-300;
  constexpr double kEnough = 1e-15;
  constexpr int kMost = 500;
  const auto keep = [](double value) { return std::abs(value) < kTiny ? kTiny : value; };
  double c = 1.0, d = 1.0 / keep(1.0 - (a + b) * x / (a + 1.0)), h = d;
  for (int i = 1; i <= kMost; ++i) {
    const double m = i;
    const double even = m * (b - m) * x / ((a + 2.0 * m - 1.0) * (a + 2.0 * m));
    d = 1.0 / keep(1.0 + even * d);
    c = keep(1.0 + even / c);
    h *= d * c;
    const double odd = -(a + m) * (a + b + m) * x / ((a + 2.0 * m) * (a + 2.0 * m + 1.0));
    d = 1.0 / keep(1.0 + odd * d);
    c = keep(1.0 + odd / c);
    h *= d * c;
    if (std::abs(d * c - 1.0) < kEnough) break;
  }
  return h;
}

}  // namespace

double incomplete_beta(double x, double a, double b) {
  if (x <= 0.0) return 0.0;
  if (x >= 1.0) return 1.0;
  const double front =
      std::exp(std::lgamma(a + b) - std::lgamma(a) - std::lgamma(b) + a * std::log(x) + b * std::log1p(-x));
  if (x < (a + 1.0) / (a + b + 2.0)) return front * beta_fraction(x, a, b) / a;
  return 1.0 - front * beta_fraction(1.0 - x, b, a) / b;
}

double f_tail(double f, double freedom) {
  if (!(f > 0.0)) return 1.0;
  return incomplete_beta(freedom / (freedom + f), 0.5 * freedom, 0.5);
}

double f_quantile(double probability, double freedom) {
  double low = 0.0, high = 1.0;
  while (f_tail(high, freedom) > probability && high < 1e12) high *= 2.0;
  for (int i = 0; i < 200 && high - low > 1e-12 * high; ++i) {
    const double middle = 0.5 * (low + high);
    (f_tail(middle, freedom) > probability ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

// Fisher and Cornish 1960 (Abramowitz and Stegun 26.7.5): f_quantile(0.05, freedom) without a search.
double student_widening(double freedom) {
  constexpr double z = 1.959964;
  constexpr double z2 = z * z;
  const double inverse = 1.0 / freedom;
  const double g1 = (z2 + 1.0) / 4.0;
  const double g2 = ((5.0 * z2 + 16.0) * z2 + 3.0) / 96.0;
  const double g3 = (((3.0 * z2 + 19.0) * z2 + 17.0) * z2 - 15.0) / 384.0;
  const double g4 = ((((79.0 * z2 + 776.0) * z2 + 1482.0) * z2 - 1920.0) * z2 - 945.0) / 92160.0;
  const double t_over_z = 1.0 + inverse * (g1 + inverse * (g2 + inverse * (g3 + inverse * g4)));
  return t_over_z * t_over_z;
}

}  // namespace fathom
