// Whether what is left was large once, for a while: a collision, a snag, a wall that came near. Bursts come again; one
// alone correlates too few neighbours to be told by that.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace fathom::diagnosis {

struct Episode {
  double share{};               ///< of the variance, that its samples make beyond ordinary ones
  double log_odds{-1.0};        ///< natural, that its samples' being together is no chance
  std::size_t run{};            ///< where it is
  std::size_t first{}, last{};  ///< samples of that run
};

/// The least likely company that large samples keep: the most of the largest p n of n independent ones that stand
/// within L samples, a binomial's tail over all places, lengths and p that are asked (scan statistic; Glaz, Naus,
/// Wallenstein 2001). Ranks alone count, so that outliers, however large, are nothing without company. `runs`: what
/// unforetold() gives, or other independent noise; gaps are NaN.
[[nodiscard]] Episode episode(std::span<const std::vector<double>> runs);

}  // namespace fathom::diagnosis
