#include "common/estimation/spikes.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "common/base/statistics.hpp"

namespace fathom::estimation {
namespace {

constexpr double kFewSteps = 2.5;     // a longer step is a gap
constexpr double kEqualSteps = 1e-3;  // of a step: whole microseconds pass
constexpr double kSpike = 12.0;       // robust sigmas of the misfit to four neighbours
constexpr double kBack = 0.5;         // of that limit: from either side, a spike is off by more

/// Weights of four neighbours in the cubic through them, at time 0.
std::array<double, 4> cubic_weights(const std::array<double, 4>& t) {
  std::array<double, 4> weight{1.0, 1.0, 1.0, 1.0};
  for (std::size_t k = 0; k < 4; ++k) {
    for (std::size_t j = 0; j < 4; ++j) {
      if (j != k) weight[k] *= t[j] / (t[j] - t[k]);
    }
  }
  return weight;
}

/// Misfit of every sample to the cubic through its four neighbours; 0 beside a gap, across which nothing is foretold.
template <class T>
std::vector<double> neighbour_misfit(const std::vector<double>& t, const std::vector<T>& x) {
  const double step = typical_step(t);
  std::vector<double> misfit(x.size(), 0.0);
  for (std::size_t i = 2; i + 2 < x.size(); ++i) {
    const std::array<double, 4> near{t[i - 2] - t[i], t[i - 1] - t[i], t[i + 1] - t[i], t[i + 2] - t[i]};
    const std::array<double, 4> steps{near[1] - near[0], -near[1], near[2], near[3] - near[2]};
    const auto [least, most] = std::ranges::minmax(steps);
    if (most > kFewSteps * step) continue;
    if (most - least < kEqualSteps * step) {
      misfit[i] = (x[i] - (4.0 * (x[i - 1] + x[i + 1]) - x[i - 2] - x[i + 2]) / 6.0).norm();
      continue;
    }
    const std::array<double, 4> weight = cubic_weights(near);
    double square = 1.0;
    for (const double one : weight) square += one * one;
    const T apart = x[i] - (weight[0] * x[i - 2] + weight[1] * x[i - 1] + weight[2] * x[i + 1] + weight[3] * x[i + 2]);
    misfit[i] = apart.norm() * std::sqrt(70.0 / 36.0 / square);  // noise weighs as at equal steps
  }
  return misfit;
}

double limit_of(const std::vector<double>& misfit, double floor) {
  return std::max(kSpike * median(misfit) / 1.5, floor);  // median of a 3-norm is about 1.5 sigma
}

template <class T>
std::vector<std::uint8_t> beyond(const std::vector<double>& t, const std::vector<T>& x, double floor) {
  const std::vector<double> misfit = neighbour_misfit(t, x);
  const double limit = limit_of(misfit, floor);
  std::vector<std::uint8_t> bad(x.size(), 0);
  for (std::size_t i = 0; i < x.size(); ++i) bad[i] = misfit[i] > limit ? 1 : 0;
  return bad;
}

/// Whether samples `first` to `last` lie apart from the neighbour before and the one after them, and off the lines
/// through the two before and the two after, all to the same side. What bends or steps goes on from one of the two.
bool comes_back(const Series& series, std::size_t first, std::size_t last, double least) {
  const auto apart = [&](std::size_t at, std::size_t near) -> Eigen::Vector3d { return series.x[at] - series.x[near]; };
  const auto off = [&](std::size_t at, std::size_t near, std::size_t far) -> Eigen::Vector3d {
    const double steps = (series.t[at] - series.t[near]) / (series.t[near] - series.t[far]);
    return apart(at, near) - apart(near, far) * steps;
  };
  const Eigen::Vector3d before = apart(first, first - 1);
  return std::ranges::all_of(std::array<Eigen::Vector3d, 4>{before, off(first, first - 1, first - 2),
                                                            apart(last, last + 1), off(last, last + 1, last + 2)},
                             [&](const Eigen::Vector3d& one) { return one.norm() > least && one.dot(before) > 0.0; });
}

}  // namespace

std::vector<std::uint8_t> spikes(const std::vector<double>& t, const std::vector<Eigen::Vector3d>& x, double floor) {
  return beyond(t, x, floor);
}

std::vector<std::uint8_t> spikes(const std::vector<double>& t, const std::vector<Eigen::Vector4d>& x, double floor) {
  return beyond(t, x, floor);
}

std::vector<std::uint8_t> speed_spikes(const Series& series, double floor) {
  const std::vector<double> misfit = neighbour_misfit(series.t, series.x);
  const double limit = limit_of(misfit, floor);
  std::vector<std::uint8_t> bad(series.size(), 0);
  for (std::size_t i = 2; i + 2 < series.size(); ++i) {
    if (!(misfit[i] > limit)) continue;
    if (comes_back(series, i, i, kBack * limit)) bad[i] = 1;
    if (i + 3 < series.size() && comes_back(series, i, i + 1, kBack * limit)) bad[i] = bad[i + 1] = 1;
    if (i > 2 && comes_back(series, i - 1, i, kBack * limit)) bad[i - 1] = bad[i] = 1;
  }
  return bad;
}

}  // namespace fathom::estimation
