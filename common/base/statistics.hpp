// Robust statistics: numbers that a few wild samples cannot move, and error bars from deleting blocks of the data.
#pragma once

#include <span>
#include <vector>

namespace fathom {

/// Median; 0 for an empty list.
[[nodiscard]] double median(std::vector<double> values);
/// Standard deviation of normal data with the same median absolute deviation; 0 for an empty list.
[[nodiscard]] double mad_sigma(std::vector<double> values);
/// Huber's weight for a residual of `ratio` standard deviations: 1 up to `limit`, then limit / |ratio|.
[[nodiscard]] double huber_weight(double ratio, double limit = 1.5);
/// Standard deviation of white noise on a smooth uniform series, from third differences: smooth motion drops out.
[[nodiscard]] double white_noise_sigma(std::span<const double> series);
/// The same at any stamps `t`, from divided differences: at unequal steps plain ones would take motion for noise.
[[nodiscard]] double white_noise_sigma(std::span<const double> t, std::span<const double> series);
/// Of a series of which only its steps are known, each from `before` to `t`; those that do not follow on are left out.
[[nodiscard]] double white_noise_of_steps(std::span<const double> before, std::span<const double> t,
                                          std::span<const double> steps);
/// How many parts of equal weight say as much as these weights, none of them negative: (sum w)^2 / sum w^2 (Kish 1965,
/// sec. 11.7); 0 when all are zero.
[[nodiscard]] double effective_count(std::span<const double> weights);
/// Standard deviation of an estimate from its delete-one-block replicates (Efron 1982).
[[nodiscard]] double jackknife_sigma(std::span<const double> replicates);

/// Weighted mean of several measurements of one quantity; sigma is inflated when they scatter more than they say.
struct Pooled {
  double value{};
  double sigma{};
  int count{};
};
[[nodiscard]] Pooled pool(std::span<const double> values, std::span<const double> sigmas);

}  // namespace fathom
