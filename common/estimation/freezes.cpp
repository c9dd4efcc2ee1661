#include "common/estimation/freezes.hpp"

namespace fathom::estimation {
namespace {

constexpr double kLeastSeconds = 5.0;
constexpr double kLeap = 5.0;         // typical steps: larger than noise, or the resolution, makes from one to the next
constexpr double kAsUsual = 0.3;      // of the mean square that the other axes have over the whole run
constexpr double kNoisy = 0.2;        // of the typical step: a smooth signal has next to none
constexpr double kMostRepeats = 0.5;  // of an axis that is read coarsely nothing can be said

struct Spread {
  double count{}, sum{}, squares{};
  void operator()(double x) {
    ++count;
    sum += x;
    squares += x * x;
  }
  [[nodiscard]] double variance() const { return count > 0.0 ? squares / count - sum * sum / (count * count) : 0.0; }
};

}  // namespace

FrozenAxis frozen_axis(const Series& series, int axis, const std::vector<std::uint8_t>& known) {
  FrozenAxis frozen{.samples = std::vector<std::uint8_t>(series.size(), 0)};
  std::vector<double> x;
  for (const Eigen::Vector3d& one : series.x) x.push_back(one[axis]);
  const std::vector<std::size_t> length = repeat_lengths(x);
  const double step = typical_step(series.t);
  std::vector<double> steps, moving;
  for (std::size_t i = 1; i < x.size(); ++i) {
    if (static_cast<double>(length[i]) * step >= kLeastSeconds) continue;
    moving.push_back(x[i]);
    if (x[i] != x[i - 1]) steps.push_back(std::abs(x[i] - x[i - 1]));
  }
  if (static_cast<double>(steps.size()) <= kMostRepeats * static_cast<double>(moving.size())) return frozen;
  const double typical = median(std::move(steps)), leap = kLeap * typical;
  const bool noisy = white_noise_sigma(moving) > kNoisy * typical;
  const auto spread_of = [&](int other, std::size_t first, std::size_t end) {
    Spread spread;
    for (std::size_t i = first; i < end; ++i) spread(series.x[i][other]);
    return spread.variance();
  };
  for (std::size_t first = 0, end = 0; first < x.size(); first = end) {
    end = first + length[first];
    const double seconds = series.t[end - 1] - series.t[first];
    if (seconds < kLeastSeconds || known[first] != 0) continue;
    const bool leaps = (first > 0 && std::abs(x[first] - x[first - 1]) > leap) ||
                       (end < x.size() && std::abs(x[end] - x[first]) > leap);
    if (!noisy && !leaps && std::abs(x[first]) <= leap) continue;  // rest, of which noise would leave nothing still
    bool others = false;
    for (int other = 0; other < 3; ++other) {
      others = others || (other != axis && spread_of(other, first, end) > kAsUsual * spread_of(other, 0, x.size()) &&
                          spread_of(other, first, end) > 0.0);
    }
    if (!others) continue;
    std::fill(frozen.samples.begin() + static_cast<std::ptrdiff_t>(first),
              frozen.samples.begin() + static_cast<std::ptrdiff_t>(end), 1);
    if (seconds > frozen.longest) {
      frozen.longest = seconds;
      frozen.begin = series.t[first];
    }
  }
  return frozen;
}

}  // namespace fathom::estimation
