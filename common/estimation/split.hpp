// Parts of a run: its end, held out where no separate validation run exists, and the stretches between its gaps.
#pragma once

#include <cstddef>
#include <span>
#include <utility>
#include <vector>

#include "common/samples/diagnosis_result.hpp"
#include "common/samples/trial.hpp"

namespace fathom::estimation {

/// The first part and the last `held_out` share (0..1) of a run, named so. InputError when either would be empty.
[[nodiscard]] std::pair<Trial, Trial> split(const Trial& trial, double held_out);

/// Which share of a run is kept from the fits: its end, half at either end, or its beginning.
enum class Kept { kLast, kEnds, kFirst };

/// A run, and what of it judges.
struct Parts {
  Trial fitted;
  std::vector<Trial> judged;
};
/// InputError when a part would be empty.
[[nodiscard]] Parts split(const Trial& trial, double held_out, Kept kept);

/// The stretches of at least `shortest` s over which it is known what drove the vehicle, each a trial under the run's
/// name whose time goes on: nothing that looks at one trial then reaches across a gap, nor remembers what was before.
[[nodiscard]] std::vector<Trial> known_stretches(Trial trial, double shortest);

/// What of a run's input was not recorded.
struct InputGaps {
  std::size_t count{};
  double longest{}, total{};  ///< s
};
[[nodiscard]] InputGaps input_gaps(const Trial& trial);
/// One finding for each run that has any.
[[nodiscard]] std::vector<ConsistencyFinding> gap_findings(std::span<const Trial> runs);

}  // namespace fathom::estimation
