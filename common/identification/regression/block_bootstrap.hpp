// Bootstrap by blocks, from their sums alone: a resample of a trial is a weighted sum of small matrices.
#pragma once

#include <vector>

#include "common/identification/regression/lagged_gram.hpp"

namespace fathom::identification {

/// Coefficients of `columns` over resampled blocks (Kuensch 1989): one row per repetition. phi stays.
[[nodiscard]] Eigen::MatrixXd block_bootstrap(const LaggedGram& gram, const std::vector<int>& columns, double phi,
                                              int repetitions, unsigned seed);

}  // namespace fathom::identification
