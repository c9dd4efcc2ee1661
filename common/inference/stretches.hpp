// Long recordings are searched on stretches first: what acts is seen in minutes, hours tell its numbers.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "common/inference/fitted_models.hpp"
#include "common/samples/trial.hpp"

namespace fathom::inference {

/// Parts of runs that stand for all of them.
struct Stretches {
  std::vector<Trial> trials;
  std::vector<std::size_t> run;  ///< of Problem::runs, of each of them
  double of_whole{1.0};          ///< length of all runs over theirs
};

/// Stretches of together about `Thresholds::search_blocks` blocks, spread evenly, at least one of every run; nothing:
/// the recordings are hardly longer than that.
[[nodiscard]] std::optional<Stretches> stretches_of(const likelihood::Problem& whole, const Thresholds& thresholds);

/// Where a fit of whole runs begins: a fit of stretches, with what belongs to one run as the mean over its stretches.
[[nodiscard]] Start on_whole_runs(const likelihood::Fit& of_stretches, const Stretches& stretches, std::size_t runs);

}  // namespace fathom::inference
