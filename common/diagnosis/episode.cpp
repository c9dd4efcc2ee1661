#include "common/diagnosis/episode.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>

namespace fathom::diagnosis {
namespace {

constexpr double kFewest = 60.0;                     // samples
constexpr std::array kLengths{4, 6, 9, 13, 20, 30};  // samples
constexpr std::array kLargest{0.01, 0.02, 0.05};     // of all samples
constexpr int kCompany = 3;                          // fewer are a coincidence of outliers
constexpr double kOfOrdinary = 0.95;                 // of all samples: those that tell the ordinary variance

/// Natural logarithm of the chance that `count` or more of `length` samples are among the largest share `p`.
double log_tail(int count, int length, double p) {
  double tail = 0.0;
  for (int k = count; k <= length; ++k) {
    tail += std::exp(std::lgamma(length + 1.0) - std::lgamma(k + 1.0) - std::lgamma(length - k + 1.0) +
                     k * std::log(p) + (length - k) * std::log1p(-p));
  }
  return std::log(std::min(tail, 1.0));
}

/// The fullest place of `length` samples in a row, of which none is missing.
struct Place {
  int count{};
  std::size_t run{}, from{};
};
Place fullest(std::span<const std::vector<double>> runs, double threshold, std::size_t length) {
  Place best;
  for (std::size_t r = 0; r < runs.size(); ++r) {
    int count = 0;
    std::size_t whole = 0;
    for (std::size_t k = 0; k < runs[r].size(); ++k) {
      if (!std::isfinite(runs[r][k])) {
        whole = 0;
        count = 0;
        continue;
      }
      count += std::abs(runs[r][k]) >= threshold ? 1 : 0;
      if (++whole > length) {
        count -= std::abs(runs[r][k - length]) >= threshold ? 1 : 0;
        whole = length;
      }
      if (whole == length && count > best.count) best = {count, r, k + 1 - length};
    }
  }
  return best;
}

/// Share of the squares that is gone when the episode's samples are no larger than ordinary ones.
double share_of(std::span<const std::vector<double>> runs, const Episode& found, double threshold_of_ordinary) {
  double ordinary = 0.0, ordinary_count = 0.0, all = 0.0, of_episode = 0.0, count = 0.0;
  for (std::size_t r = 0; r < runs.size(); ++r) {
    for (std::size_t k = 0; k < runs[r].size(); ++k) {
      const double square = runs[r][k] * runs[r][k];
      if (!std::isfinite(square)) continue;
      all += square;
      if (std::abs(runs[r][k]) < threshold_of_ordinary) {
        ordinary += square;
        ordinary_count += 1.0;
      }
      if (r != found.run || k < found.first || k > found.last) continue;
      of_episode += square;
      count += 1.0;
    }
  }
  if (!(all > 0.0) || ordinary_count == 0.0) return 0.0;
  return std::max(of_episode - count * ordinary / ordinary_count, 0.0) / all;
}

}  // namespace

Episode episode(std::span<const std::vector<double>> runs) {
  std::vector<double> sizes;
  for (const std::vector<double>& run : runs) {
    for (const double x : run) {
      if (std::isfinite(x)) sizes.push_back(std::abs(x));
    }
  }
  const auto n = static_cast<double>(sizes.size());
  if (n < kFewest) return {};
  std::ranges::sort(sizes, std::greater{});
  const auto largest = [&](double share) { return sizes[static_cast<std::size_t>(std::ceil(share * n)) - 1]; };
  const double price = std::log(n * static_cast<double>(kLengths.size() * kLargest.size()));
  Episode found;
  for (const double share : kLargest) {
    const double threshold = largest(share);
    if (!(threshold > 0.0)) continue;
    // Values that are told in steps are often equal: all that reach the threshold count.
    const double p =
        static_cast<double>(std::ranges::upper_bound(sizes, threshold, std::greater{}) - sizes.begin()) / n;
    for (const int length : kLengths) {
      const Place place = fullest(runs, threshold, static_cast<std::size_t>(length));
      if (place.count < kCompany) continue;
      const double log_odds = -log_tail(place.count, length, p) - price;
      if (log_odds <= found.log_odds) continue;
      const auto large = [&](std::size_t k) { return std::abs(runs[place.run][k]) >= threshold; };
      std::size_t first = place.from, last = place.from + static_cast<std::size_t>(length) - 1;
      while (!large(first)) ++first;
      while (!large(last)) --last;
      found = {.log_odds = log_odds, .run = place.run, .first = first, .last = last};
    }
  }
  if (found.log_odds > 0.0) found.share = share_of(runs, found, largest(1.0 - kOfOrdinary));
  return found;
}

}  // namespace fathom::diagnosis
