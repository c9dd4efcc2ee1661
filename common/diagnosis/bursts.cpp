#include "common/diagnosis/bursts.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>

#include "common/identification/lag_sums.hpp"

namespace fathom::diagnosis {
namespace {

constexpr double kFewest = 60.0;       // samples
constexpr double kNormalMad = 0.6745;  // median of |x| over the standard deviation, of normal noise
constexpr double kLarge = 2.5;         // ordinary sizes: 1 % of normal noise
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr int kGroups = 3;

/// Ranks from 0 on; equal values share the middle of theirs.
std::vector<double> ranks(std::span<const double> values) {
  std::vector<std::size_t> order(values.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order, {}, [&](std::size_t i) { return values[i]; });
  std::vector<double> rank(values.size());
  for (std::size_t from = 0, to = 0; from < order.size(); from = to) {
    while (to < order.size() && values[order[to]] == values[order[from]]) ++to;
    for (std::size_t i = from; i < to; ++i) rank[order[i]] = 0.5 * static_cast<double>(from + to - 1);
  }
  return rank;
}

/// Finite samples of all runs in order, and for each whether the next one is its neighbour in time.
struct Series {
  std::vector<double> value;
  std::vector<bool> goes_on;

  explicit Series(std::span<const std::vector<double>> runs) {
    for (const std::vector<double>& run : runs) {
      for (std::size_t k = 0; k < run.size(); ++k) {
        if (!std::isfinite(run[k])) continue;
        value.push_back(run[k]);
        goes_on.push_back(k + 1 < run.size() && std::isfinite(run[k + 1]));
      }
    }
  }
};

/// Mean product of neighbours over mean square, of values without their mean.
double alike(std::span<const double> values, const std::vector<bool>& goes_on) {
  const double n = static_cast<double>(values.size());
  const double mean = std::accumulate(values.begin(), values.end(), 0.0) / n;
  double products = 0.0, squares = 0.0, pairs = 0.0;
  for (std::size_t k = 0; k < values.size(); ++k) {
    squares += (values[k] - mean) * (values[k] - mean);
    if (!goes_on[k]) continue;
    products += (values[k] - mean) * (values[k + 1] - mean);
    pairs += 1.0;
  }
  return squares > 0.0 && pairs > 0.0 ? products / pairs / (squares / n) : 0.0;
}

/// Standard deviation of normal noise with this median size.
double ordinary_size(std::vector<double> sizes) {
  std::ranges::nth_element(sizes, sizes.begin() + static_cast<std::ptrdiff_t>(sizes.size() / 2));
  return sizes[sizes.size() / 2] / kNormalMad;
}

}  // namespace

std::vector<std::vector<double>> unforetold(std::span<const Eigen::VectorXd> residuals) {
  std::vector<double> sizes;
  for (const Eigen::VectorXd& run : residuals) {
    for (const double x : run) {
      if (std::isfinite(x)) sizes.push_back(std::abs(x));
    }
  }
  std::vector<std::vector<double>> left;
  for (const Eigen::VectorXd& run : residuals) left.emplace_back(static_cast<std::size_t>(run.size()), kNaN);
  if (sizes.empty()) return left;
  const double bound = kLarge * ordinary_size(std::move(sizes));
  constexpr auto kMemory = identification::LagSums::kMemory;
  identification::LagSums sums{1};
  for (const Eigen::VectorXd& run : residuals)
    sums.add(run.unaryExpr([&](double x) { return std::abs(x) < bound ? x : kNaN; }));
  if (sums.samples() < kFewest) return left;
  const Eigen::Vector3d phi = sums.memory_of(Eigen::VectorXd::Ones(1), {0});
  for (std::size_t r = 0; r < left.size(); ++r) {
    const Eigen::VectorXd& run = residuals[r];
    for (Eigen::Index k = kMemory; k < run.size(); ++k)
      left[r][static_cast<std::size_t>(k)] = run[k] - phi.dot(run.segment<kMemory>(k - kMemory).reverse());
  }
  return left;
}

Bursts bursts(std::span<const std::vector<double>> runs) {
  const Series series{runs};
  const auto n = static_cast<double>(series.value.size());
  if (n < kFewest) return {};
  std::vector<double> size;
  double square = 0.0;
  for (const double x : series.value) {
    size.push_back(std::abs(x));
    square += x * x;
  }
  if (!(square > 0.0)) return {};
  // Ranks: whatever the distribution, those of independent samples correlate by 1 / sqrt(n) at most ordinarily.
  const double rho = std::min(alike(ranks(size), series.goes_on), 1.0 - 1e-9);
  if (!(rho > 0.0)) return {};
  const double ordinary = ordinary_size(std::move(size));
  return {.share = std::max(1.0 - ordinary * ordinary / (square / n), 0.0),
          .log_odds = -0.5 * n * std::log1p(-rho * rho) - 0.5 * std::log(n)};
}

double size_goes_with(std::span<const std::vector<double>> runs, std::span<const std::vector<double>> quantity) {
  std::vector<double> left, asked;
  std::vector<bool> goes_on;
  for (std::size_t r = 0; r < runs.size(); ++r) {
    for (std::size_t k = 0; k < runs[r].size(); ++k) {
      const auto seen = [&](std::size_t i) {
        return i < runs[r].size() && std::isfinite(runs[r][i]) && std::isfinite(quantity[r][i]);
      };
      if (!seen(k)) continue;
      left.push_back(runs[r][k]);
      asked.push_back(quantity[r][k]);
      goes_on.push_back(seen(k + 1));
    }
  }
  const auto n = static_cast<double>(left.size());
  if (n < kFewest) return -1.0;
  std::array<double, kGroups> sum{}, square{}, count{};
  std::vector<std::size_t> group;
  for (const double rank : ranks(asked)) group.push_back(static_cast<std::size_t>(kGroups * rank / n));
  for (std::size_t k = 0; k < left.size(); ++k) {
    sum[group[k]] += left[k];
    square[group[k]] += left[k] * left[k];
    count[group[k]] += 1.0;
  }
  std::array<double, kGroups> variance{};
  double pooled = 0.0;
  for (std::size_t g = 0; g < kGroups; ++g) {
    if (count[g] < kFewest / kGroups) return -1.0;  // most of what was asked is one value
    variance[g] = square[g] / count[g] - std::pow(sum[g] / count[g], 2);
    if (!(variance[g] > 0.0)) return -1.0;
    pooled += count[g] * variance[g] / n;
  }
  double evidence = 0.0, fourth = 0.0;
  for (std::size_t g = 0; g < kGroups; ++g) evidence += 0.5 * count[g] * std::log(pooled / variance[g]);
  std::vector<double> excess;
  for (std::size_t k = 0; k < left.size(); ++k) {
    const std::size_t g = group[k];
    excess.push_back(std::pow(left[k] - sum[g] / count[g], 2) / variance[g]);
    fourth += excess.back() * excess.back() / n;
  }
  // A variance is known from n squares as well as from so many fewer independent normal ones.
  const double rho = std::clamp(alike(excess, goes_on), 0.0, 0.9);
  evidence /= std::max(0.5 * (fourth - 1.0), 1.0) * (1.0 + rho) / (1.0 - rho);
  return evidence - 0.5 * (kGroups - 1) * std::log(n);
}

}  // namespace fathom::diagnosis
