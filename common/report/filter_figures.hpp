// Bode plots of a trial's complementary filters, as Karras et al. have them in Figures 1.4 (first order) and 1.5
// (second order), with the gains that the filters had.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "common/estimation/online/complementary_filter.hpp"
#include "common/estimation/online/navigator.hpp"
#include "common/estimation/smoothing/aids_seen.hpp"
#include "common/report/plot.hpp"

namespace fathom::report {

/// One filter: gains at an interval.
struct DrawnFilter {
  std::string words;  ///< whose, for the caption
  estimation::Gains gains;
  double interval{};    ///< s
  bool second_order{};  ///< velocity from a measured velocity and an accelerometer; else position
  bool published{};     ///< the paper's numbers, for comparison
};

/// Those of the horizontal axes, at the median interval of what was seen; beside optical flow and tags the paper's
/// numbers at the same interval. An aid that said too little is left out.
[[nodiscard]] std::vector<DrawnFilter> filters_of(const estimation::NavigatorSettings& settings,
                                                  const estimation::AidsSeen& seen);
/// Magnitude [dB] or phase [deg] over frequency [Hz] up to half the sample rate: what of the measurement passes, and,
/// dashed, what of the rate or acceleration. Published gains in another colour.
enum class BodePart { kMagnitude, kPhase };
[[nodiscard]] Figure draw_bode(std::span<const DrawnFilter> filters, BodePart part);

}  // namespace fathom::report
