// What the pictures show of runs that no fit has seen: measured, foretold before and after, and what is left.
#pragma once

#include <span>
#include <vector>

#include "common/model/dynamics.hpp"
#include "common/samples/diagnosis_result.hpp"
#include "common/samples/trial.hpp"

namespace fathom::residual {

/// One for each run; one row of nothing stands for each gap. `before`, `after`: models; residuals per run and sample.
[[nodiscard]] std::vector<PredictionTrace> traces_of(std::span<const Trial> unseen, const model::Model& before,
                                                     const model::Model& after,
                                                     std::span<const std::vector<Vector6d>> residual_before,
                                                     std::span<const std::vector<Vector6d>> residual_after);

}  // namespace fathom::residual
