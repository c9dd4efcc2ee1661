// The noise numbers of one axis, all else fixed: Fisher scoring on the filter that is linearised about a pass' own
// estimates, with three states (deviation of the velocity, random force, coloured sensor noise).
#pragma once

#include <span>
#include <vector>

#include "common/likelihood/filter.hpp"

namespace fathom::likelihood {

struct NoiseFit {
  AxisNoise noise;
  double gained{};  ///< of log likelihood and log prior, by the linearised filter
};

/// `runs`: the axis' reduced blocks of every run.
[[nodiscard]] NoiseFit fit_noise(std::span<const std::vector<ReducedBlock>* const> runs, const AxisNoise& start,
                                 const NoisePrior& prior, int iterations = 12);

/// Log likelihood of the axis, for tests and for the choice of the tail.
[[nodiscard]] double reduced_log_likelihood(std::span<const std::vector<ReducedBlock>* const> runs,
                                            const AxisNoise& noise);

}  // namespace fathom::likelihood
