// Reduces long series for drawing; see series.hpp.
#include "common/report/series.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace fathom::report {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr std::size_t kFewestPerBin = 5;  // a median and two quartiles of fewer say nothing

// First, last, lowest and highest sample of [begin, end) in the order of time.
void append_extremes(Polyline& line, std::span<const double> x, std::span<const double> y, std::size_t begin,
                     std::size_t end) {
  const auto first = y.begin() + static_cast<std::ptrdiff_t>(begin);
  const auto [low, high] = std::minmax_element(first, y.begin() + static_cast<std::ptrdiff_t>(end));
  const auto a = static_cast<std::size_t>(std::min(low, high) - y.begin());
  const auto b = static_cast<std::size_t>(std::max(low, high) - y.begin());
  for (const std::size_t i : {a, b}) {
    if (i == b && a == b) break;
    line.x.push_back(x[i]);
    line.y.push_back(y[i]);
  }
  if (a == b) {
    line.x.push_back(x[a]);
    line.y.push_back(y[a]);
  }
}

void append_stroke(Polyline& line, std::span<const double> x, std::span<const double> y, std::size_t begin,
                   std::size_t end, double points_per_sample) {
  if (!line.x.empty()) {
    line.x.push_back(kNaN);
    line.y.push_back(kNaN);
  }
  const std::size_t count = end - begin;
  const auto buckets =
      std::max<std::size_t>(2, static_cast<std::size_t>(0.5 * points_per_sample * static_cast<double>(count)));
  if (points_per_sample >= 1.0 || count <= 2 * buckets) {
    line.x.insert(line.x.end(), x.begin() + static_cast<std::ptrdiff_t>(begin),
                  x.begin() + static_cast<std::ptrdiff_t>(end));
    line.y.insert(line.y.end(), y.begin() + static_cast<std::ptrdiff_t>(begin),
                  y.begin() + static_cast<std::ptrdiff_t>(end));
    return;
  }
  for (std::size_t k = 0; k < buckets; ++k) {
    append_extremes(line, x, y, begin + k * count / buckets, begin + (k + 1) * count / buckets);
  }
}

// Indices of finite pairs, by rising x.
std::vector<std::size_t> by_x(std::span<const double> x, std::span<const double> y) {
  std::vector<std::size_t> order;
  for (std::size_t i = 0; i < std::min(x.size(), y.size()); ++i) {
    if (std::isfinite(x[i]) && std::isfinite(y[i])) order.push_back(i);
  }
  std::ranges::stable_sort(order, {}, [&](std::size_t i) { return x[i]; });
  return order;
}

std::size_t usable_bins(std::size_t samples, std::size_t bins) { return std::min(bins, samples / kFewestPerBin); }

}  // namespace

Polyline decimate(std::span<const double> x, std::span<const double> y, std::size_t max_points,
                  std::span<const std::size_t> breaks) {
  Polyline line;
  const std::size_t size = std::min(x.size(), y.size());
  const double ratio = size == 0 ? 1.0 : static_cast<double>(max_points) / static_cast<double>(size);
  std::size_t begin = 0;
  auto next_break = breaks.begin();
  for (std::size_t i = 0; i <= size; ++i) {
    while (next_break != breaks.end() && *next_break < i) ++next_break;
    const bool cut = next_break != breaks.end() && *next_break == i;
    const bool gap = i == size || !std::isfinite(y[i]);
    if ((cut || gap) && i > begin) append_stroke(line, x, y, begin, i, ratio);
    if (cut) begin = i;
    if (gap) begin = i + 1;
  }
  return line;
}

double quantile(std::span<const double> values, double share) {
  std::vector<double> sorted;
  std::ranges::copy_if(values, std::back_inserter(sorted), [](double v) { return std::isfinite(v); });
  if (sorted.empty()) return kNaN;
  const auto at = static_cast<std::ptrdiff_t>(std::lround(share * static_cast<double>(sorted.size() - 1)));
  std::nth_element(sorted.begin(), sorted.begin() + at, sorted.end());
  return sorted[static_cast<std::size_t>(at)];
}

std::vector<Bin> binned(std::span<const double> x, std::span<const double> y, std::size_t bins) {
  const auto order = by_x(x, y);
  const std::size_t count = usable_bins(order.size(), bins);
  std::vector<Bin> result;
  std::vector<double> values;
  for (std::size_t k = 0; k < count; ++k) {
    const std::size_t begin = k * order.size() / count;
    const std::size_t end = (k + 1) * order.size() / count;
    values.clear();
    for (std::size_t i = begin; i < end; ++i) values.push_back(y[order[i]]);
    result.push_back(
        {x[order[(begin + end) / 2]], quantile(values, 0.25), quantile(values, 0.5), quantile(values, 0.75)});
  }
  return result;
}

double dependence(std::span<const double> x, std::span<const double> y, std::size_t bins, double independent_share) {
  const auto order = by_x(x, y);
  const std::size_t count = usable_bins(order.size(), bins);
  if (count < 2 || x[order.front()] == x[order.back()]) return kNaN;
  const auto samples = static_cast<double>(order.size());
  const double independent = std::min(independent_share, 1.0) * samples;
  if (!(independent > static_cast<double>(count) + 1.0)) return kNaN;
  const double mean =
      std::accumulate(order.begin(), order.end(), 0.0, [&](double s, std::size_t i) { return s + y[i]; }) / samples;
  double total = 0.0;
  double within = 0.0;
  for (std::size_t k = 0; k < count; ++k) {
    const std::size_t begin = k * order.size() / count;
    const std::size_t end = (k + 1) * order.size() / count;
    double sum = 0.0;
    for (std::size_t i = begin; i < end; ++i) sum += y[order[i]];
    const double local = sum / static_cast<double>(end - begin);
    for (std::size_t i = begin; i < end; ++i) {
      total += (y[order[i]] - mean) * (y[order[i]] - mean);
      within += (y[order[i]] - local) * (y[order[i]] - local);
    }
  }
  if (total <= 0.0) return kNaN;
  // The adjusted R2 of a regression on bin membership, with the independent samples as its sample size.
  const double adjusted = 1.0 - within / total * (independent - 1.0) / (independent - static_cast<double>(count));
  return std::clamp(adjusted, 0.0, 1.0);
}

std::vector<double> autocorrelation(std::span<const std::vector<double>> records, std::size_t stride,
                                    std::size_t count) {
  double sum = 0.0;
  std::size_t samples = 0;
  for (const auto& record : records) {
    for (const double v : record) {
      if (!std::isfinite(v)) continue;
      sum += v;
      ++samples;
    }
  }
  std::vector<double> result(count, kNaN);
  if (samples < 2) return result;
  const double mean = sum / static_cast<double>(samples);
  double variance = 0.0;
  for (std::size_t lag = 0; lag < count; ++lag) {
    double products = 0.0;
    std::size_t pairs = 0;
    for (const auto& record : records) {
      for (std::size_t i = lag * stride; i < record.size(); ++i) {
        const double product = (record[i] - mean) * (record[i - lag * stride] - mean);
        if (!std::isfinite(product)) continue;
        products += product;
        ++pairs;
      }
    }
    if (pairs == 0) continue;
    if (lag == 0) variance = products / static_cast<double>(pairs);
    if (variance > 0.0) result[lag] = products / static_cast<double>(pairs) / variance;
  }
  return result;
}

}  // namespace fathom::report
