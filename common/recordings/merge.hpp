// Several recordings of one run become one, on the clock of the first.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "common/samples/recording.hpp"

namespace fathom::recordings {

/// Adds `seconds` to every time of the streams that instruments give.
void shift(Recording& recording, double seconds);

struct FoundShift {
  double seconds{};      ///< to add to the times of the second
  double correlation{};  ///< of what both measured, there
  std::string by;        ///< "turn rate"
};

/// What must be added to `second`'s times so that the motion that both measured (turn rate, depth, speed) falls
/// together; nothing where they have none in common, or where another shift does nearly as well.
[[nodiscard]] std::optional<FoundShift> find_shift(const Recording& first, const Recording& second);

/// One run of all `parts`. `stated` shifts [s] are taken as they are; others are found by the motion, or zero where
/// both clocks are of the day and overlap. A stream that two parts have is the first's. InputError where a clock cannot
/// be told.
[[nodiscard]] Recording merge(std::vector<Recording> parts, const std::vector<std::optional<double>>& stated,
                              std::vector<std::string>& notes);

}  // namespace fathom::recordings
