// Tail probabilities for tests of significance.
#pragma once

namespace fathom {

/// Regularised incomplete beta function I_x(a, b), 0 <= x <= 1, a and b positive.
[[nodiscard]] double incomplete_beta(double x, double a, double b);
/// Probability that an F-distributed number with 1 and `freedom` degrees of freedom exceeds `f`.
[[nodiscard]] double f_tail(double f, double freedom);
/// The value that is exceeded with `probability`: the inverse of f_tail.
[[nodiscard]] double f_quantile(double probability, double freedom);
/// The square of what Student's t exceeds in size with a probability of 5 %, over that of a Gaussian number: by how
/// much a variance that was seen with so much freedom must be widened to give 95 % intervals. To 1 % from freedom 3
/// upwards.
[[nodiscard]] double student_widening(double freedom);

}  // namespace fathom
