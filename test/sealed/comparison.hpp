// The same sets by several cores of the tool: one table, with the interval of every rate.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "test/sealed/judge.hpp"

namespace fathom::sealed {

/// What one core made of the sets.
struct CoreScores {
  std::string core;
  std::vector<Score> scores;
};

/// A share and its 95 % interval.
struct Rate {
  double share{kUnknown}, low{0.0}, high{1.0};
};
/// Score interval of a binomial share (Wilson 1927): within 0 and 1 and honest where all or none came.
[[nodiscard]] Rate wilson(long part, long whole);

/// Markdown. Sets that not all cores have answered are left out, so that every row compares the same sets.
[[nodiscard]] std::string to_comparison(std::span<const CoreScores> cores, const std::string& how);

}  // namespace fathom::sealed
