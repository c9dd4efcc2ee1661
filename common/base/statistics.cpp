#include "common/base/statistics.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace fathom {
namespace {

constexpr double kEqualSteps = 1e-3;  // of a step: whole microseconds pass

bool equal_steps(std::span<const double> t) {
  const double step = (t.back() - t.front()) / static_cast<double>(t.size() - 1);
  for (std::size_t i = 1; i < t.size(); ++i) {
    if (std::abs(t[i] - t[i - 1] - step) > kEqualSteps * step) return false;
  }
  return true;
}

/// Weights of the divided difference over all stamps `t`, as large as those of the plain one are for white noise.
template <std::size_t kCount>
std::array<double, kCount> divided_difference(std::span<const double> t, double square_of_plain) {
  std::array<double, kCount> weight{};
  double square = 0.0;
  for (std::size_t i = 0; i < kCount; ++i) {
    double product = 1.0;
    for (std::size_t j = 0; j < kCount; ++j) {
      if (j != i) product *= (t[i] - t[j]) / (t.back() - t.front());
    }
    weight[i] = 1.0 / product;
    square += weight[i] * weight[i];
  }
  for (double& one : weight) one *= std::sqrt(square_of_plain / square);
  return weight;
}

}  // namespace

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

double white_noise_sigma(std::span<const double> t, std::span<const double> series) {
  std::vector<double> third;
  for (std::size_t i = 3; i < series.size(); ++i) {
    const auto four = t.subspan(i - 3, 4);
    if (equal_steps(four)) {
      third.push_back(series[i] - 3.0 * series[i - 1] + 3.0 * series[i - 2] - series[i - 3]);
      continue;
    }
    const auto weight = divided_difference<4>(four, 20.0);
    double sum = 0.0;
    for (std::size_t k = 0; k < 4; ++k) sum += weight[k] * series[i - 3 + k];
    third.push_back(sum);
  }
  return mad_sigma(std::move(third)) / std::sqrt(20.0);
}

double white_noise_of_steps(std::span<const double> before, std::span<const double> t, std::span<const double> steps) {
  std::vector<double> fourth;
  for (std::size_t i = 3; i < steps.size(); ++i) {
    std::array<double, 5> five{before[i - 3]};
    bool follow = true;
    for (std::size_t k = 0; k < 4; ++k) {
      five[k + 1] = t[i - 3 + k];
      follow = follow && five[k] == before[i - 3 + k];
    }
    if (!follow) continue;
    if (equal_steps(five)) {
      fourth.push_back(steps[i] - 3.0 * steps[i - 1] + 3.0 * steps[i - 2] - steps[i - 3]);
      continue;
    }
    const auto weight = divided_difference<5>(five, 70.0);
    double share = 0.0, sum = 0.0;  // a step moves all that comes after it
    for (std::size_t k = 4; k-- > 0;) {
      share += weight[k + 1];
      sum += share * steps[i - 3 + k];
    }
    fourth.push_back(sum);
  }
  return mad_sigma(std::move(fourth)) / std::sqrt(20.0) * std::sqrt(20.0 / 70.0);  // 1 + 16 + 36 + 16 + 1
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
