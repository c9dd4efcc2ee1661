// One number that several recordings estimate: do they share a value off neutral, and which of them has its own? Where
// the recordings contradict each other (a heading zeroed at each start), each one that is sure has its own.
#pragma once

#include <limits>
#include <span>
#include <vector>

#include "common/base/statistics.hpp"

namespace fathom::consistency {

/// What one recording says.
struct Estimate {
  double value{};
  double sigma{std::numeric_limits<double>::infinity()};
  bool informative{false};
  double freedom{};  ///< degrees of freedom of sigma
};

/// The decision over recordings.
struct SharedValue {
  Pooled pooled;
  bool found{false};                   ///< significant, large enough, and repeated
  double limit{};                      ///< sigmas that count as significant with this much data
  double freedom{};                    ///< degrees of freedom of the pooled sigma
  std::vector<double> applied;         ///< per recording: its value, or neutral
  std::vector<std::size_t> different;  ///< recordings with a value of their own
  bool disagree{};                     ///< they contradict each other, and none is the exception
};

/// A value within `floor` of `neutral` does not matter, however sure it is.
[[nodiscard]] SharedValue share(std::span<const Estimate> estimates, double neutral, double floor);

}  // namespace fathom::consistency
