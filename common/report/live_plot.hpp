// Plots that a reader zooms, moves and asks for values: a still picture with its numbers beside it, drawn anew by uPlot
// (common/report/web) where scripts run. Print and readers without scripts keep the still one.
#pragma once

#include <limits>
#include <string>
#include <string_view>
#include <vector>

namespace fathom::report {

struct LiveCurve {
  std::string name, colour;
  std::vector<double> values;  ///< not finite: a gap
  bool anew{};                 ///< begins anew at each mark: no line leads there
};

struct LivePlot {
  std::string title;      ///< "surge u [m/s]"
  std::string group;      ///< plots of one group show the same stretch of time
  std::vector<double> t;  ///< s, rising
  std::vector<LiveCurve> curves;
  std::vector<double> marks;                               ///< s, thin vertical lines
  double floor{-std::numeric_limits<double>::infinity()};  ///< what lies beyond is cut off
  double ceiling{std::numeric_limits<double>::infinity()};
};

/// HTML of the plot; `still` is its picture. Every `every`th sample is kept, to a
/// two-thousandth of its curve's range or finer.
[[nodiscard]] std::string live_plot(const std::string& still, const LivePlot& plot, std::size_t every);

/// What forbids the page to load anything, for its head, before all else: only live_script()'s scripts run.
[[nodiscard]] std::string live_policy();
/// Style sheet, for the head.
[[nodiscard]] std::string live_style();
/// The library with its licence, and what draws the plots; for the head.
[[nodiscard]] std::string live_script();

extern const std::string_view kPlotStyle, kPlotLicence, kPlotLibrary, kPlotScript;

}  // namespace fathom::report
