// The pictures of the report, each as a script for gnuplot; and the numbers that stand beside them.
#pragma once

#include <array>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "common/report/live_plot.hpp"
#include "common/report/plot.hpp"
#include "common/samples/diagnosis_result.hpp"

namespace fathom::report {

/// Measured dark, before orange, after blue: told apart by every kind of colour vision, and in grey.
constexpr const char* kMeasuredColour = "#22262b";
constexpr const char* kBeforeColour = "#e07b00";
constexpr const char* kAfterColour = "#0a5ea8";

/// A quantity that the residual might follow.
struct Quantity {
  std::string name;            ///< "heading"
  std::string label;           ///< "heading [deg]"
  std::vector<double> values;  ///< of all traces, one after the other
};

/// Residuals of all traces of one axis [N or N m], one after the other.
struct Leftover {
  std::vector<double> before;
  std::vector<double> after;
};

/// Autocorrelation before and after.
struct Memory {
  std::vector<double> lag;  ///< s
  std::vector<double> before;
  std::vector<double> after;
  std::size_t samples_per_lag{1};
  double band{};  ///< half width of the 95 % band of a series without memory
};

/// Samples [begin, end) of a trace.
struct Stretch {
  std::size_t begin{};
  std::size_t end{};
};

/// The stretch of about `seconds` in which the base model errs by its median: neither the best nor the worst is shown
/// in close-up. Nothing when the trace is hardly longer than that.
[[nodiscard]] std::optional<Stretch> typical_stretch(const PredictionTrace& trace, double seconds);
/// Nothing where the axis has no residual.
[[nodiscard]] std::optional<Leftover> leftover(std::span<const PredictionTrace> traces, std::size_t axis);
/// What the residual of this axis is held against; quantities that were not recorded or never changed are left out.
[[nodiscard]] std::vector<Quantity> quantities(std::span<const PredictionTrace> traces, std::size_t axis);
[[nodiscard]] Memory memory(std::span<const PredictionTrace> traces, std::size_t axis);
/// Independent samples per sample of a series with this autocorrelation: 1 without memory.
[[nodiscard]] double independent_share(const Memory& memory, const std::vector<double>& correlation);

[[nodiscard]] Figure draw_errors(const DiagnosisResult& result, std::size_t axis);
/// The whole run, or the close-up of a part of it.
[[nodiscard]] Figure draw_motion(const PredictionTrace& trace, std::size_t axis, std::size_t max_points,
                                 const std::optional<Stretch>& close_up = std::nullopt);
/// The numbers of draw_motion(), to be looked into.
[[nodiscard]] LivePlot live_motion(const PredictionTrace& trace, std::size_t axis,
                                   const std::optional<Stretch>& close_up = std::nullopt);
[[nodiscard]] Figure draw_dependence(const Leftover& leftover, const Quantity& quantity, std::size_t axis);
[[nodiscard]] Figure draw_memory(const Memory& memory, std::size_t axis);

}  // namespace fathom::report
