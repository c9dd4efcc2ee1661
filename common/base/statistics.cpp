#include "common/base/statistics.hpp"

#include <algorithm>
#include <cmath>

namespace fathom {

double median(std::vector<double> values) {
  if (values.empty()) return 0.0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  if (values.size() % 2 == 1) return *middle;
  return 0.5 * (*middle + *std::max_element(values.begin(), middle));
}

double mad_sigma(std::vector<double> values) {
  constexpr double kNormal = 1.4826;  // sigma of a normal law over its median absolute deviation
  const double centre = median(values);
  for (double& value : values) value = std::abs(value - centre);
  return kNormal * median(std::move(values));
}

double huber_weight(double ratio, double limit) {
  const double size = std::abs(ratio);
  return size <= limit ? 1.0 : limit / size;
}

double white_noise_sigma(std::span<const double> series) {
  std::vector<double> third;
  for (std::size_t i = 3; i < series.size(); ++i) {
    third.push_back(series[i] - 3.0 * series[i - 1] + 3.0 * series[i - 2] - series[i - 3]);
  }
  return mad_sigma(std::move(third)) / std::sqrt(20.0);  // 1 + 9 + 9 + 1
}

double effective_count(std::span<const double> weights) {
  double sum = 0.0, square = 0.0;
  for (const double weight : weights) {
    sum += weight;
    square += weight * weight;
  }
  return square > 0.0 ? sum * sum / square : 0.0;
}

double jackknife_sigma(std::span<const double> replicates) {
  const auto n = static_cast<double>(replicates.size());
  if (replicates.size() < 2) return 0.0;
  double mean = 0.0;
  for (const double value : replicates) mean += value / n;
  double sum = 0.0;
  for (const double value : replicates) sum += (value - mean) * (value - mean);
  return std::sqrt(sum * (n - 1.0) / n);
}

Pooled pool(std::span<const double> values, std::span<const double> sigmas) {
  Pooled pooled;
  double weights = 0.0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (!(sigmas[i] > 0.0) || !std::isfinite(values[i]) || !std::isfinite(sigmas[i])) continue;
    const double weight = 1.0 / (sigmas[i] * sigmas[i]);
    weights += weight;
    pooled.value += weight * values[i];
    ++pooled.count;
  }
  if (pooled.count == 0) return pooled;
  pooled.value /= weights;
  double chi2 = 0.0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (!(sigmas[i] > 0.0) || !std::isfinite(values[i]) || !std::isfinite(sigmas[i])) continue;
    chi2 += std::pow((values[i] - pooled.value) / sigmas[i], 2);
  }
  const double excess = pooled.count > 1 ? std::max(1.0, chi2 / (pooled.count - 1)) : 1.0;
  pooled.sigma = std::sqrt(excess / weights);
  return pooled;
}

}  // namespace fathom
