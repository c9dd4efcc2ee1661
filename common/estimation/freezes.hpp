// Values that stand still to the last bit although the vehicle moves: a dead sensor, or one axis of it.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include "common/base/statistics.hpp"
#include "common/estimation/held_values.hpp"
#include "common/estimation/timeline.hpp"

namespace fathom::estimation {

/// Repeats of at least `least` samples after which the value leaps; `longest` grows to the longest, in s. Rest without
/// noise does not leap.
template <class T>
[[nodiscard]] std::vector<std::uint8_t> freezes(const std::vector<T>& x, std::size_t least, double& longest,
                                                double step) {
  std::vector<std::uint8_t> bad(x.size(), 0);
  const std::vector<std::size_t> length = repeat_lengths(x);
  std::vector<double> steps;
  for (std::size_t i = 1; i < x.size(); ++i) {
    const double size = (x[i] - x[i - 1]).norm();
    if (size > 0.0) steps.push_back(size);
  }
  const double typical = median(std::move(steps));
  for (std::size_t first = 0, end = 0; first < x.size(); first = end) {
    end = first + length[first];
    if (length[first] < least) continue;
    const double leap = end < x.size() ? (x[end] - x[first]).norm() : std::numeric_limits<double>::infinity();
    const double entry = first > 0 ? (x[first] - x[first - 1]).norm() : 0.0;
    // Noise alone makes an ordinary step; a value that never moves again while others do is frozen as well.
    if (leap < 0.3 * typical || (end == x.size() && entry == 0.0)) continue;
    std::fill(bad.begin() + static_cast<std::ptrdiff_t>(first), bad.begin() + static_cast<std::ptrdiff_t>(end), 1);
    longest = std::max(longest, static_cast<double>(length[first]) * step);
  }
  return bad;
}

struct FrozenAxis {
  std::vector<std::uint8_t> samples{};  ///< 1 where it stands still
  double begin{};                       ///< s, of the longest stretch
  double longest{};                     ///< s; 0: it never does
};

/// One axis that stands still for seconds while another moves as it usually does. An axis without noise that rests
/// near zero does not stand still, nor one that steps by its own resolution, and one that never moves is not measured.
/// Samples that are `known` to be frozen are left alone.
[[nodiscard]] FrozenAxis frozen_axis(const Series& series, int axis, const std::vector<std::uint8_t>& known);

}  // namespace fathom::estimation
