// What belongs to a run and not to the vehicle: a wave's phase, the moment of a change, where the water goes. An effect
// that was learnt in other runs is not refuted by a validation run that has other numbers of this kind; they are set by
// its first half, and judged is the second.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "common/identification/trajectory_fit.hpp"

namespace fathom::diagnosis {

struct OwnRun {
  model::Model model;                ///< with the run's own numbers; all else as it was learnt
  std::vector<std::string> effects;  ///< whose numbers are its own
};

/// Nothing where the model's effects have no such numbers, or where more than one run is to be judged by.
[[nodiscard]] std::optional<OwnRun> with_own_numbers(const identification::FitResult& learnt,
                                                     const model::Vehicle& vehicle, std::span<const Trial> unseen,
                                                     const identification::FitSettings& settings);

/// Those windows that begin in the second half of their run.
[[nodiscard]] std::vector<model::Window> second_half(std::span<const model::Window> windows,
                                                     std::span<const Trial> unseen);

}  // namespace fathom::diagnosis
