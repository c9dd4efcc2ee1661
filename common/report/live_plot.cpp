#include "common/report/live_plot.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>
#include <span>

#include "common/report/text.hpp"

namespace fathom::report {
namespace {

constexpr double kLeast = 1e-3;       // s: times are told to
constexpr double kResolution = 5e-4;  // of a curve's range: finer than a pixel of a plot that fills a screen

std::string digits(double value) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.4g", value);
  return std::isfinite(value) ? text.data() : "";
}

/// The power of ten at or below `size`; 1 where there is none.
double decade(double size) {
  return std::isfinite(size) && size > 0.0 ? std::pow(10.0, std::floor(std::log10(size))) : 1.0;
}

/// "step:first,difference,..." in whole steps: a third of the length of the numbers themselves. A gap is empty, and the
/// next difference is from the last number.
class Differences {
 public:
  explicit Differences(double step) : step_{step} {
    std::array<char, 32> text{};
    std::snprintf(text.data(), text.size(), "%.0e:", step);
    text_ = text.data();
  }
  void add(double value) {
    if (!first_) text_ += ',';
    first_ = false;
    if (!std::isfinite(value)) return;
    const auto whole = static_cast<long long>(std::llround(value / step_));
    text_ += std::to_string(whole - last_);
    last_ = whole;
  }
  [[nodiscard]] const std::string& text() const { return text_; }

 private:
  double step_;
  std::string text_;
  long long last_{};
  bool first_{true};
};

std::string times(std::span<const double> values, std::size_t every) {
  Differences row{kLeast};
  for (std::size_t i = 0; i < values.size(); i += every) row.add(values[i]);
  return row.text();
}

std::string row_of(const LiveCurve& curve, const LivePlot& plot, std::size_t every) {
  double low = std::numeric_limits<double>::infinity(), high = -low;
  for (const double value : curve.values) {
    if (!std::isfinite(value)) continue;
    low = std::min(low, value);
    high = std::max(high, value);
  }
  Differences row{decade(kResolution * (high - low))};
  auto mark = plot.marks.begin();
  for (std::size_t i = 0; i < curve.values.size(); i += every) {
    while (mark != plot.marks.end() && *mark <= plot.t[i]) ++mark;
    const std::size_t next = i + every;
    const bool last = curve.anew && mark != plot.marks.end() && next < plot.t.size() && *mark <= plot.t[next];
    row.add(last ? std::numeric_limits<double>::quiet_NaN() : curve.values[i]);
  }
  return row.text();
}

constexpr const char* kOwnStyle =
    ".plot nav{text-align:right;margin-top:-4px}.plot button{font:14px inherit;min-width:34px;margin-left:4px;"
    "border:1px solid #b8bec7;border-radius:4px;background:#fff;color:#22262b;cursor:pointer}.plot.on "
    ".still{display:none}"
    ".plot .u-legend{width:auto;margin:0}.plot .u-legend td,.plot .u-legend th{border:0;padding:0 3px}"
    ".plot .u-title{font-size:15px;text-align:left;padding-left:58px}.plot .u-legend{font-size:13px}"
    "@media print{.plot.on .still{display:block}.plot .live{display:none}}";

}  // namespace

std::string live_plot(const std::string& still, const LivePlot& plot, std::size_t every) {
  const std::size_t step = std::max<std::size_t>(every, 1);
  std::string names, colours, rows;
  for (const LiveCurve& curve : plot.curves) {
    const char* between = names.empty() ? "" : "|";
    names += between + escape(curve.name);
    colours += between + escape(curve.colour);
    rows += (rows.empty() ? "" : ";") + row_of(curve, plot, step);
  }
  return "<div class=\"plot\" data-title=\"" + escape(plot.title) + "\" data-group=\"" + escape(plot.group) +
         "\" data-names=\"" + names + "\" data-colours=\"" + colours + "\" data-t=\"" + times(plot.t, step) +
         "\" data-y=\"" + rows + "\" data-marks=\"" + times(plot.marks, 1) + "\" data-floor=\"" + digits(plot.floor) +
         "\" data-ceiling=\"" + digits(plot.ceiling) + "\"><div class=\"still\">" + still + "</div></div>";
}

std::string live_policy() {
  return "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; style-src 'unsafe-inline'; "
         "script-src 'nonce-fathom'\">";
}

std::string live_style() { return "<style>" + std::string{kPlotStyle} + kOwnStyle + "</style>"; }

std::string live_script() {
  const auto script = [](const std::string& text) { return "<script nonce=\"fathom\">" + text + "</script>\n"; };
  return script("/* uPlot 1.6.32\n" + std::string{kPlotLicence} + "*/\n" + std::string{kPlotLibrary}) +
         script(std::string{kPlotScript});
}

}  // namespace fathom::report
