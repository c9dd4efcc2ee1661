// A learned force as pictures: each of its groups over each of its arguments, with the band that the weights'
// covariance leaves, as far as the recording has been.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "common/model/learned/features.hpp"
#include "common/report/plot.hpp"
#include "common/samples/correction.hpp"

namespace fathom::report {

/// A group over one argument: what else it reads stays at half of what was visited, places and times at their middle.
struct CorrectionCurve {
  std::string title, argument, unit;
  std::vector<double> x, force,
      sigma;  ///< argument in SI; N, N m, or the share of the drag or thrust that it acts along
};
[[nodiscard]] std::vector<CorrectionCurve> correction_curves(const CorrectionGiven& given);
/// `truth`, where it is known: of the same x.
[[nodiscard]] Figure draw_correction(const CorrectionCurve& curve, const std::vector<double>& truth = {});

}  // namespace fathom::report
