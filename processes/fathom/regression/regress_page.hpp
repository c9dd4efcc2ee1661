// What a stepwise regression found, as a page for people.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "common/identification/regression/manoeuvre_regression.hpp"

namespace fathom::tool {

/// A complete page, HTML: how many derivatives stand, each with its 95 % interval beside the reference's, and what
/// would explain as much; manoeuvres one by one fold out. `more`: sections that follow, with an album's marks.
[[nodiscard]] std::string regress_page(const std::vector<identification::AxisRegression>& axes,
                                       std::span<const identification::ManoeuvreRows> runs,
                                       const model::Vehicle& vehicle,
                                       const identification::RegressionSettings& settings, const std::string& more);

}  // namespace fathom::tool
