// A line in a spectrum that stands out from its neighbourhood: noise with a memory has a smooth spectrum, something
// that swings at a frequency of its own has not.
#pragma once

#include <span>

namespace fathom::diagnosis {

struct Line {
  double frequency{};  ///< Hz
  double share{};      ///< of the series' variance
  double log_odds{};   ///< natural, that it is no chance, all frequencies having been asked; below zero without a line
};

/// The line that stands out most. `series`: at steps of `step` s, its mean removed; gaps are zero.
[[nodiscard]] Line strongest_line(std::span<const double> series, double step);

}  // namespace fathom::diagnosis
