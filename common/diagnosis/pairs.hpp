// Two effects of which neither stands alone: what one leaves drowns the other. By first looks, which two would explain
// most together.
#pragma once

#include <vector>

#include "common/diagnosis/questions.hpp"

namespace fathom::diagnosis {

/// Places of two answers, which can act at once, whose changes together explain more than either.
struct Pair {
  std::size_t first{}, second{};
  double share{};                        ///< of the error (RMS) that they promise to remove
  double least_left{};                   ///< of it along some axis, as they promise; for the best pairs
  double of_first{1.0}, of_second{1.0};  ///< times what each does by itself
};

/// The `most` pairs that promise most, each with the best forms of its two effects.
[[nodiscard]] std::vector<Pair> promising_pairs(const Answers& answers, std::size_t most);

}  // namespace fathom::diagnosis
