#include "common/diagnosis/oscillation.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <unsupported/Eigen/FFT>
#include <vector>

namespace fathom::diagnosis {
namespace {

constexpr std::size_t kFewest = 60;      // samples
constexpr std::size_t kLowest = 6;       // cycles in the series: slower swings are drift
constexpr std::size_t kPeak = 3;         // bins that a line spreads over to each side of its own, through Hann's window
constexpr std::size_t kNeighbours = 14;  // bins to each side, the peak's among them
constexpr std::size_t kFewestNeighbours = 8;
constexpr double kAlike = 1.94;  // neighbouring bins through Hann's window for one of their own: 1 + 2 (4/9 + 1/36)

}  // namespace

Line strongest_line(std::span<const double> series, double step) {
  Line best{.log_odds = -1.0};
  const std::size_t n = series.size();
  if (n < kFewest) return best;
  std::vector<double> windowed(n);
  for (std::size_t k = 0; k < n; ++k) {
    const double phase = 2.0 * std::numbers::pi * (static_cast<double>(k) + 0.5) / static_cast<double>(n);
    windowed[k] = series[k] * 0.5 * (1.0 - std::cos(phase));
  }
  Eigen::FFT<double> transform;
  std::vector<std::complex<double>> spectrum;
  transform.fwd(spectrum, windowed);
  std::vector<double> power;
  for (std::size_t i = 0; i <= n / 2; ++i) power.push_back(std::norm(spectrum[i]));
  double all = 0.0;
  for (std::size_t i = 1; i < power.size(); ++i) all += power[i];
  for (std::size_t i = kLowest; i + 1 < power.size(); ++i) {
    double sum = 0.0, count = 0.0, peak = 0.0;
    const std::size_t low = std::max<std::size_t>(1, i > kNeighbours ? i - kNeighbours : 1);
    for (std::size_t j = low; j < std::min(i + kNeighbours + 1, power.size()); ++j) {
      if (j + kPeak < i || j > i + kPeak) {
        sum += power[j];
        count += 1.0;
      } else {
        peak += power[j];
      }
    }
    if (count < kFewestNeighbours || sum <= 0.0) continue;
    // An exponential variable over the mean of n others: (1 + ratio / n)^-n is its chance, and all bins are tried.
    const double ratio = power[i] * count / sum, others = count / kAlike;
    const double log_odds = others * std::log1p(ratio / others) - std::log(static_cast<double>(power.size()));
    if (log_odds > best.log_odds)
      best = {.frequency = static_cast<double>(i) / (static_cast<double>(n) * step),
              .share = peak / all,
              .log_odds = log_odds};
  }
  return best;
}

}  // namespace fathom::diagnosis
