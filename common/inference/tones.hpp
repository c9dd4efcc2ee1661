// What swings: the strongest lines in what a model leaves.
#pragma once

#include <vector>

#include "common/likelihood/filter.hpp"

namespace fathom::inference {

/// Two strongest lines, from `lowest` [rad/s] on, of the likelihood's slope with a force toward world axis `w`.
/// `slope`: likelihood::adjoint per run.
[[nodiscard]] std::vector<double> strongest_tones(const likelihood::Problem& problem,
                                                  const std::vector<Eigen::MatrixXd>& slope, int w, double lowest);

}  // namespace fathom::inference
