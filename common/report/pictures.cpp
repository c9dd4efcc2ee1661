// Scripts for the report's pictures. Data travel inside the script, so a figure is one self-contained text.
#include "common/report/pictures.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "common/report/series.hpp"
#include "common/report/text.hpp"

namespace fathom::report {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kDegrees = 180.0 / std::numbers::pi;
constexpr std::size_t kDots = 160;  // per panel and model: enough to see the cloud, few enough for a small file
constexpr std::size_t kBins = 10;
constexpr double kLongestLag = 10.0;  // s
constexpr std::size_t kLags = 101;

std::string text(double value) { return std::isfinite(value) ? number(value, 6) : "NaN"; }

std::string block(const char* name, const Polyline& line) {
  std::string data = std::string("$") + name + " << EOD\n";
  for (std::size_t i = 0; i < line.x.size(); ++i) {
    data += std::isfinite(line.y[i]) ? text(line.x[i]) + " " + text(line.y[i]) + "\n" : "\n";
  }
  if (line.x.empty()) data += "NaN NaN\n";
  return data + "EOD\n";
}

// Narrow enough to stand over a bar: three decimals, more only for what would vanish.
std::string short_number(double value) { return number(value, value < 0.01 && value >= 0.002 ? 1 : 2); }

// The axis' name above the upper left corner: upright, and clear of the numbers.
std::string heading(const std::string& words) {
  return "set label 100 " + quoted(words) + " at graph 0, graph 1 left offset -5, 0.8 textcolor rgb '#22262b'\n";
}

std::string below(const std::string& words) {
  return "set xlabel " + quoted(words) + " offset 0, 0.6 textcolor rgb '#444b55'\n";
}

std::string range(const char* axis, double low, double high) {
  return std::string("set ") + axis + "range [" + text(low) + ":" + text(high) + "]\n";
}

// Height of a picture from `low` to `high`; of what is constant but for rounding, a height that numbers can be written
// at.
double span_of(double low, double high) {
  constexpr double kRounding = 1e-4;
  const double size = std::fmax(std::fmax(std::abs(low), std::abs(high)), 1e-6);
  return high - low > kRounding * size ? high - low : std::fmax(size, 1.0);
}

// A round step that divides `span` into three to six parts.
double tick_step(double span) {
  const double raw = span / 5.0;
  const double decade = std::pow(10.0, std::floor(std::log10(raw)));
  const double part = raw / decade;
  return decade * (part > 5.0 ? 10.0 : part > 2.0 ? 5.0 : part > 1.0 ? 2.0 : 1.0);
}

double clamped(double value, double low, double high) {
  return std::isfinite(value) ? std::clamp(value, low, high) : value;
}

std::vector<double> column(const std::vector<std::array<double, 6>>& rows, std::size_t axis, double scale) {
  std::vector<double> values;
  values.reserve(rows.size());
  for (const auto& row : rows) values.push_back(scale * row[axis]);
  return values;
}

// All traces' values of one kind; NaN where a trace does not have as many as it has times.
template <typename Row, typename Pick>
std::vector<double> gathered(std::span<const PredictionTrace> traces, std::vector<Row> PredictionTrace::*rows,
                             Pick pick) {
  std::vector<double> values;
  for (const auto& trace : traces) {
    for (std::size_t i = 0; i < trace.t.size(); ++i) {
      values.push_back(i < (trace.*rows).size() ? pick((trace.*rows)[i]) : kNaN);
    }
  }
  return values;
}

bool varies(const std::vector<double>& values) {
  const double low = quantile(values, 0.02);
  const double high = quantile(values, 0.98);
  return high - low > 1e-9 * (1.0 + std::abs(high));
}

bool any_value(const std::vector<double>& values) {
  return std::ranges::any_of(values, [](double v) { return std::isfinite(v) && v != 0.0; });
}

double spacing(const PredictionTrace& trace) {
  if (trace.t.size() < 2) return 0.0;
  return (trace.t.back() - trace.t.front()) / static_cast<double>(trace.t.size() - 1);
}

struct Frame {
  double floor{}, ceiling{};
};

/// A model that runs away must not squeeze the measurement flat: it may leave the frame by half its height.
Frame frame_of(std::span<const double> measured, std::span<const double> before, std::span<const double> after) {
  double low = quantile(measured, 0.0);
  double high = quantile(measured, 1.0);
  if (!std::isfinite(low)) low = std::fmin(quantile(before, 0.0), quantile(after, 0.0));
  if (!std::isfinite(high)) high = std::fmax(quantile(before, 1.0), quantile(after, 1.0));
  const double span = span_of(low, high);
  const double lowest = std::fmin(low, std::fmin(quantile(before, 0.0), quantile(after, 0.0)));
  const double highest = std::fmax(high, std::fmax(quantile(before, 1.0), quantile(after, 1.0)));
  return {std::fmax(low - 0.5 * span, lowest) - 0.05 * span, std::fmin(high + 0.5 * span, highest) + 0.05 * span};
}

}  // namespace

std::optional<Leftover> leftover(std::span<const PredictionTrace> traces, std::size_t axis) {
  const auto pick = [&](const auto& row) { return row[axis]; };
  Leftover result{gathered(traces, &PredictionTrace::residual_before, pick),
                  gathered(traces, &PredictionTrace::residual_after, pick)};
  if (!any_value(result.before) && !any_value(result.after)) return std::nullopt;
  return result;
}

std::vector<Quantity> quantities(std::span<const PredictionTrace> traces, std::size_t axis) {
  const Axis& a = kAxes[axis];
  std::vector<Quantity> all;
  const auto position = [&](std::size_t i) {
    return gathered(traces, &PredictionTrace::position, [i](const auto& p) {
      return p == std::array<double, 3>{} ? kNaN : p[i];  // exactly zero stands for: not observed
    });
  };
  all.push_back({"time", "time since start [s]", gathered(traces, &PredictionTrace::t, [](double t) { return t; })});
  all.push_back({"north", "position north [m]", position(0)});
  all.push_back({"east", "position east [m]", position(1)});
  all.push_back({"depth", "position down [m]", position(2)});
  all.push_back({"heading", "heading [deg]", gathered(traces, &PredictionTrace::heading, [](double h) {
                   return kDegrees * std::remainder(h, 2.0 * std::numbers::pi);
                 })});
  all.push_back({"own speed", velocity_label(a),
                 gathered(traces, &PredictionTrace::measured, [&](const auto& nu) { return a.scale * nu[axis]; })});
  all.push_back({"total speed", "total speed [m/s]", gathered(traces, &PredictionTrace::measured, [](const auto& nu) {
                   return std::hypot(nu[0], nu[1], nu[2]);
                 })});
  all.push_back({"thrust", std::string("thrust ") + a.force + " [" + a.force_unit + "]",
                 gathered(traces, &PredictionTrace::tau, [&](const auto& tau) { return tau[axis]; })});
  all.push_back(
      {"voltage", "battery voltage [V]", gathered(traces, &PredictionTrace::voltage, [](double v) { return v; })});
  std::erase_if(all, [](const Quantity& q) { return !varies(q.values); });
  return all;
}

Memory memory(std::span<const PredictionTrace> traces, std::size_t axis) {
  Memory result;
  double dt = 0.0;
  double duration = 0.0;
  std::array<std::vector<std::vector<double>>, 2> records;
  for (const auto& trace : traces) {
    dt = std::max(dt, spacing(trace));
    duration = std::max(duration, trace.t.empty() ? 0.0 : trace.t.back() - trace.t.front());
    records[0].push_back(column(trace.residual_before, axis, 1.0));
    records[1].push_back(column(trace.residual_after, axis, 1.0));
  }
  if (dt <= 0.0) return result;
  const double longest = std::min(kLongestLag, 0.25 * duration);
  const auto stride = std::max<std::size_t>(1, static_cast<std::size_t>(std::ceil(longest / dt / (kLags - 1) - 1e-6)));
  result.samples_per_lag = stride;
  const auto count = static_cast<std::size_t>(longest / (dt * static_cast<double>(stride)) + 1e-6) + 1;
  for (std::size_t i = 0; i < count; ++i) result.lag.push_back(dt * static_cast<double>(i * stride));
  result.before = autocorrelation(records[0], stride, count);
  result.after = autocorrelation(records[1], stride, count);
  std::ptrdiff_t samples = 0;
  for (const auto& record : records[any_value(result.after) ? 1 : 0]) {
    samples += std::ranges::count_if(record, [](double v) { return std::isfinite(v); });
  }
  result.band = samples > 0 ? kNormal95 / std::sqrt(static_cast<double>(samples)) : kNaN;
  return result;
}

double independent_share(const Memory& memory, const std::vector<double>& correlation) {
  // Integrated up to the first crossing of zero (Sokal's window in its simplest form).
  double integral = 0.5;
  for (std::size_t i = 1; i < correlation.size() && correlation[i] > 0.0; ++i) integral += correlation[i];
  return 1.0 / std::max(1.0, 2.0 * integral * static_cast<double>(memory.samples_per_lag));
}

Figure draw_errors(const DiagnosisResult& result, std::size_t axis) {
  const Axis& a = kAxes[axis];
  constexpr double kOffset = 0.21;
  std::string ticks;
  std::string bars[2];
  double top = 0.0;
  const ModelError* errors[2] = {&result.error_before, &result.error_after};
  std::vector<double> horizons;
  for (const auto* error : errors) {
    for (const auto& p : error->prediction) {
      if (std::ranges::find(horizons, p.horizon_s) == horizons.end()) horizons.push_back(p.horizon_s);
    }
  }
  std::ranges::sort(horizons);
  for (std::size_t h = 0; h < horizons.size(); ++h) {
    ticks += (h ? ", " : "") + quoted(plain(horizons[h]) + " s ahead") + " " + std::to_string(h);
    for (std::size_t k = 0; k < 2; ++k) {
      for (const auto& p : errors[k]->prediction) {
        if (p.horizon_s != horizons[h] || !std::isfinite(p.rmse[axis])) continue;
        const double value = a.scale * p.rmse[axis];
        top = std::max(top, value);
        bars[k] += text(static_cast<double>(h) + (k ? kOffset : -kOffset)) + " " + text(value) + " " +
                   short_number(value) + "\n";
      }
    }
  }
  Figure figure{"Prediction error of " + velocity_label(a) + " before and after, per horizon", 290, 190};
  figure.bottom = 24;
  figure.script = "$b << EOD\n" + (bars[0].empty() ? "NaN NaN 0\n" : bars[0]) + "EOD\n$a << EOD\n" +
                  (bars[1].empty() ? "NaN NaN 0\n" : bars[1]) + "EOD\n" + heading(velocity_label(a)) +
                  range("x", -0.55, static_cast<double>(horizons.size()) - 0.45) +
                  range("y", 0.0, top > 0.0 ? 1.15 * top : 1.0) + "unset grid\nset grid ytics\nset ytics 0, " +
                  text(tick_step(top > 0.0 ? top : 1.0)) + "\nset xtics (" + ticks +
                  ") scale 0\nset boxwidth 0.38\nplot $b u 1:2 w boxes lc rgb '" + kBeforeColour +
                  "', $a u 1:2 w boxes lc rgb '" + kAfterColour +
                  "', $b u 1:2:3 w labels offset 0,0.6 font ',11' textcolor rgb '#444b55', $a u 1:2:3 w labels offset "
                  "0,0.6 font ',11' textcolor rgb '#22262b'\n";
  return figure;
}

std::optional<Stretch> typical_stretch(const PredictionTrace& trace, double seconds) {
  const double dt = spacing(trace);
  const std::size_t size = std::min(trace.t.size(), trace.before.size());
  const std::size_t length = dt > 0.0 ? static_cast<std::size_t>(seconds / dt) : 0;
  if (length < 10 || 2 * length > size || trace.measured.size() < size) return std::nullopt;
  std::vector<std::size_t> starts;
  for (const std::size_t i : trace.restarts) {
    if (i + length <= size && (starts.empty() || i >= starts.back() + length)) starts.push_back(i);
  }
  if (starts.empty()) {
    for (std::size_t i = 0; i + length <= size; i += length) starts.push_back(i);
  }
  const auto squared = [&](std::size_t begin, std::size_t end) {
    std::array<double, 6> sum{};
    for (std::size_t i = begin; i < end; ++i) {
      for (std::size_t k = 0; k < 6; ++k) {
        const double d = trace.before[i][k] - trace.measured[i][k];
        if (std::isfinite(d)) sum[k] += d * d;
      }
    }
    return sum;
  };
  const auto whole = squared(0, size);
  std::vector<double> errors;  // every axis weighs the same
  for (const std::size_t start : starts) {
    const auto part = squared(start, start + length);
    double error = 0.0;
    for (std::size_t k = 0; k < 6; ++k) error += whole[k] > 0.0 ? part[k] / whole[k] : 0.0;
    errors.push_back(error);
  }
  const auto median = static_cast<std::size_t>(std::ranges::find(errors, quantile(errors, 0.5)) - errors.begin());
  return Stretch{starts[median], starts[median] + length};
}

Figure draw_motion(const PredictionTrace& trace, std::size_t axis, std::size_t max_points,
                   const std::optional<Stretch>& close_up) {
  const Axis& a = kAxes[axis];
  const std::size_t size = trace.t.size();
  const Stretch shown = close_up.value_or(Stretch{0, size});
  const std::size_t count = shown.end - shown.begin;
  const auto part = [&](const std::vector<std::array<double, 6>>& rows) {
    auto values = column(rows, axis, a.scale);
    values.resize(size, kNaN);
    return std::vector<double>(values.begin() + static_cast<std::ptrdiff_t>(shown.begin),
                               values.begin() + static_cast<std::ptrdiff_t>(shown.end));
  };
  const std::span<const double> t = std::span(trace.t).subspan(shown.begin, count);
  const auto measured = part(trace.measured);
  auto before = part(trace.before);
  auto after = part(trace.after);
  const auto [floor, ceiling] = frame_of(measured, before, after);
  for (auto* series : {&before, &after}) {
    for (double& v : *series) v = clamped(v, floor, ceiling);
  }
  Polyline marks;
  std::vector<std::size_t> restarts;
  for (const std::size_t i : trace.restarts) {
    if (i < shown.begin || i >= shown.end) continue;
    restarts.push_back(i - shown.begin);
    marks.x.insert(marks.x.end(), {trace.t[i], trace.t[i], kNaN});
    marks.y.insert(marks.y.end(), {floor, ceiling, kNaN});
  }
  const char* which = close_up ? "Close-up of" : "Measured and predicted";
  Figure figure{std::string(which) + " " + velocity_label(a) + " of run " + trace.run, 580, 210};
  const char* width = close_up ? "2.6" : "1.2";
  const char* thick = close_up ? "3.4" : "1.8";
  figure.script = block("w", marks) + block("m", decimate(t, measured, max_points)) +
                  block("b", decimate(t, before, max_points, restarts)) +
                  block("a", decimate(t, after, max_points, restarts)) +
                  heading(velocity_label(a) + (close_up ? ", close-up" : ", whole run")) + below("time [s]") +
                  range("x", t.front(), t.back()) + range("y", floor, ceiling) +
                  "unset grid\nset grid ytics\nset ytics " + text(tick_step(1.2 * (ceiling - floor))) +
                  "\nset xzeroaxis lt 1 lc rgb '#b8bec7' lw 1\nplot $w w l lc rgb '#d3d8de' lw 1, $m w l lc rgb '" +
                  kMeasuredColour + "' lw " + thick + ", $b w l lc rgb '" + kBeforeColour + "' lw " + width +
                  ", $a w l lc rgb '" + kAfterColour + "' lw " + width + "\n";
  return figure;
}

LivePlot live_motion(const PredictionTrace& trace, std::size_t axis, const std::optional<Stretch>& close_up) {
  const Axis& a = kAxes[axis];
  const Stretch shown = close_up.value_or(Stretch{0, trace.t.size()});
  const auto part = [&](const std::vector<std::array<double, 6>>& rows) {
    auto values = column(rows, axis, a.scale);
    values.resize(trace.t.size(), kNaN);
    return std::vector<double>(values.begin() + static_cast<std::ptrdiff_t>(shown.begin),
                               values.begin() + static_cast<std::ptrdiff_t>(shown.end));
  };
  LivePlot plot{.title = velocity_label(a), .group = trace.run};
  plot.t.assign(trace.t.begin() + static_cast<std::ptrdiff_t>(shown.begin),
                trace.t.begin() + static_cast<std::ptrdiff_t>(shown.end));
  plot.curves = {{"measured", kMeasuredColour, part(trace.measured)},
                 {"before", kBeforeColour, part(trace.before), true},
                 {"after", kAfterColour, part(trace.after), true}};
  const Frame frame = frame_of(plot.curves[0].values, plot.curves[1].values, plot.curves[2].values);
  plot.floor = frame.floor;
  plot.ceiling = frame.ceiling;
  for (const std::size_t i : trace.restarts) {
    if (i >= shown.begin && i < shown.end) plot.marks.push_back(trace.t[i]);
  }
  return plot;
}

Figure draw_dependence(const Leftover& leftover, const Quantity& quantity, std::size_t axis) {
  const Axis& a = kAxes[axis];
  const double left = quantile(quantity.values, 0.002);
  const double right = quantile(quantity.values, 0.998);
  const double low = std::fmin(quantile(leftover.before, 0.04), quantile(leftover.after, 0.04));
  const double high = std::fmax(quantile(leftover.before, 0.96), quantile(leftover.after, 0.96));
  const double span = span_of(low, high);
  const double floor = low - 0.1 * span;
  const double ceiling = high + 0.1 * span;
  const double width = span_of(left, right);
  std::string data;
  const std::vector<double>* series[2] = {&leftover.before, &leftover.after};
  for (std::size_t k = 0; k < 2; ++k) {
    // Dots as strokes too short to see: gnuplot's own points cost three times the bytes.
    Polyline dots;
    const std::size_t step = std::max<std::size_t>(1, series[k]->size() / kDots);
    for (std::size_t i = k * step / 2; i < series[k]->size(); i += step) {
      const double x = quantity.values[i];
      const double y = (*series[k])[i];
      if (!(x >= left && x <= right && y >= floor && y <= ceiling)) continue;
      dots.x.insert(dots.x.end(), {x, x + 0.001 * width, kNaN});
      dots.y.insert(dots.y.end(), {y, y, kNaN});
    }
    data += block(k ? "da" : "db", dots);
    data += std::string("$") + (k ? "a" : "b") + " << EOD\n";
    const auto bins = binned(quantity.values, *series[k], kBins);
    for (const Bin& bin : bins) {
      const double shift = (k ? 0.006 : -0.006) * width;
      data += text(bin.x + shift) + " " + text(bin.median) + " " + text(bin.low) + " " + text(bin.high) + "\n";
    }
    data += bins.empty() ? "NaN NaN NaN NaN\nEOD\n" : "EOD\n";
  }
  Figure figure{"Leftover " + force_label(a) + " against " + quantity.label, 360, 190};
  figure.script = data + heading("leftover " + std::string(a.force) + " [" + a.force_unit + "]") +
                  below(quantity.label) + range("x", left - 0.03 * width, right + 0.03 * width) +
                  range("y", floor, ceiling) + "set xzeroaxis lt 1 lc rgb '#8a8f98' lw 1\nset xtics " +
                  (quantity.name == "heading" && width > 180.0 ? "90" : text(tick_step(width))) + "\nset ytics " +
                  text(tick_step(1.3 * (ceiling - floor))) + "\n";
  figure.script += std::string("plot $db w l lc rgb '#f0bd80' lw 2.4, $da w l lc rgb '#84aed3' lw 2.4, ") +
                   "$b w yerrorbars pt 5 ps 0.45 lw 1.6 lc rgb '" + kBeforeColour + "', $b w l lw 1.6 lc rgb '" +
                   kBeforeColour + "', $a w yerrorbars pt 7 ps 0.5 lw 1.6 lc rgb '" + kAfterColour +
                   "', $a w l lw 1.6 lc rgb '" + kAfterColour + "'\n";
  return figure;
}

Figure draw_memory(const Memory& memory, std::size_t axis) {
  const Axis& a = kAxes[axis];
  Figure figure{"Autocorrelation of the leftover " + force_label(a), 360, 190};
  double low = -0.2;
  for (const auto* series : {&memory.before, &memory.after}) low = std::fmin(low, 1.1 * quantile(*series, 0.0));
  const double end = memory.lag.empty() ? 1.0 : memory.lag.back();
  const Polyline band{{0.0, end}, {memory.band, memory.band}};
  figure.script =
      block("band", band) + block("b", {memory.lag, memory.before}) + block("a", {memory.lag, memory.after}) +
      heading(force_label(a)) + below("time between two samples [s]") + range("x", 0.0, end) + range("y", low, 1.05) +
      "set xzeroaxis lt 1 lc rgb '#8a8f98' lw 1\nset ytics 0.5\nplot $band u 1:(-$2):2 w filledcurves lc rgb "
      "'#cdd2d9', $b w l lw 2 lc rgb '" +
      kBeforeColour + "', $a w l lw 2 lc rgb '" + kAfterColour + "'\n";
  return figure;
}

}  // namespace fathom::report
