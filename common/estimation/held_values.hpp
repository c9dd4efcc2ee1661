// Sample and hold: a slow sensor in a faster table, its value repeated until the next one comes.
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

#include "common/estimation/timeline.hpp"

namespace fathom::estimation {

/// Length of the run of exact repeats that each sample belongs to (1: it differs from both neighbours).
template <class T>
std::vector<std::size_t> repeat_lengths(const std::vector<T>& x) {
  std::vector<std::size_t> length(x.size(), 1);
  for (std::size_t first = 0, end = 0; first < x.size(); first = end) {
    end = first + 1;
    while (end < x.size() && x[end] == x[first]) ++end;
    std::fill(length.begin() + static_cast<std::ptrdiff_t>(first), length.begin() + static_cast<std::ptrdiff_t>(end),
              end - first);
  }
  return length;
}

/// The fresh samples of a series that is held; empty when it is not.
[[nodiscard]] Series without_held(const Series& series);
/// The same. Where position and attitude are held at rates of their own, the slower one tells which samples stay.
[[nodiscard]] PoseSeries without_held(const PoseSeries& pose);

}  // namespace fathom::estimation
