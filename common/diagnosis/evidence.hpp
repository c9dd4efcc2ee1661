// How strongly windows of data speak for one model against another, when neighbouring samples are not independent.
#pragma once

#include <span>
#include <vector>

namespace fathom::diagnosis {

/// Log-likelihood ratio that counts windows, not samples. With d_w the fall of window w's cost,
/// W = 4 (sum d)^2 / sum (d - mean d)^2 is the square of a t-statistic (for one parameter and small d), and
/// n/2 ln(1 + W/n) its likelihood ratio with unknown variance (exact for the normal regression). 0 when the sum falls.
[[nodiscard]] double robust_log_likelihood_ratio(std::span<const double> cost_without,
                                                 std::span<const double> cost_with);

/// What `parameters` cost (BIC with the number of windows), and having tried `tried` candidates (Bonferroni prior).
[[nodiscard]] double price(int parameters, double windows, int tried);

/// Natural log odds for the larger model: the ratio above, less its price.
[[nodiscard]] double log_odds(std::span<const double> cost_without, std::span<const double> cost_with, int parameters,
                              int tried);

}  // namespace fathom::diagnosis
