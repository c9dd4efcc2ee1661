// What a stepwise regression found, for programs.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "common/identification/regression/manoeuvre_regression.hpp"

namespace fathom::tool {

/// One object per axis: each manoeuvre and all together, their terms with value, std, F and p, and what was refused.
[[nodiscard]] std::string regression_json(const std::vector<identification::AxisRegression>& axes,
                                          std::span<const identification::ManoeuvreRows> runs,
                                          const model::Vehicle& vehicle,
                                          const identification::RegressionSettings& settings);

}  // namespace fathom::tool
