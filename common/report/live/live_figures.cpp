#include "common/report/live/live_figures.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

#include "common/report/live/live_trial.hpp"
#include "common/report/pictures.hpp"
#include "common/report/series.hpp"
#include "common/report/text.hpp"

namespace fathom::report {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr std::size_t kMostPoints = 1200;  // per curve
constexpr std::size_t kMostDots = 900;
constexpr Utime kTogether = 5'000;  // us between a truth and its state
constexpr double kEdge = 0.15;      // of a parameter's range left free above and below

std::string text(double value) { return std::isfinite(value) ? number(value, 6) : "NaN"; }

std::string line_block(const char* name, const Polyline& line) {
  std::string data = std::string{"$"} + name + " << EOD\n";
  for (std::size_t i = 0; i < line.x.size(); ++i) {
    data += std::isfinite(line.y[i]) ? text(line.x[i]) + " " + text(line.y[i]) + "\n" : "\n";
  }
  if (line.x.empty()) data += "NaN NaN\n";
  return data + "EOD\n";
}

std::string heading(const std::string& words) {
  return "set label 100 " + quoted(words) + " at graph 0, graph 1 left offset -5, 0.8 textcolor rgb '#22262b'\n";
}
std::string below(const std::string& words) {
  return "set xlabel " + quoted(words) + " offset 0, 0.6 textcolor rgb '#444b55'\n";
}

/// Position in W or velocity in B.
double component(const StateEstimate& state, std::size_t axis) {
  const auto k = static_cast<Eigen::Index>(axis);
  return k < 3 ? state.p_WB[k] : state.nu[k - 3];
}

const char* component_name(std::size_t axis) {
  constexpr std::array kNames{"x north [m]",     "y east [m]",    "z down [m]",
                              "u forward [m/s]", "v right [m/s]", "w down [m/s]"};
  return kNames[axis];
}

// Every nth sample: dots need not keep extremes, the eye takes their cloud.
std::string dots(const char* name, const estimation::Seen& seen, std::size_t x_axis, std::size_t y_axis,
                 bool over_time) {
  const std::size_t every = std::max<std::size_t>(1, seen.t.size() / kMostDots);
  std::string data = std::string{"$"} + name + " << EOD\n";
  for (std::size_t i = 0; i < seen.t.size(); i += every) {
    const double x = over_time ? seen.t[i] : seen.x[i][static_cast<Eigen::Index>(x_axis)];
    const double y = seen.x[i][static_cast<Eigen::Index>(y_axis)];
    if (std::isfinite(x) && std::isfinite(y)) data += text(x) + " " + text(y) + "\n";
  }
  return data + "NaN NaN\nEOD\n";
}

std::string dot_style(const char* colour) { return std::string{" with points pt 7 ps 0.22 lc rgb '"} + colour + "'"; }

Polyline estimate(const Recording& recording, std::size_t axis) {
  const Utime origin = trial_origin(recording);
  std::vector<double> t, y;
  for (const StateEstimate& state : recording.state) {
    t.push_back(seconds_between(origin, state.utime));
    y.push_back(state.valid ? component(state, axis) : kNaN);
  }
  return decimate(t, y, kMostPoints);
}

/// The range that holds what is drawn, wild aids aside.
std::string y_range(const Polyline& line) {
  double low = kNaN, high = kNaN;
  for (const double y : line.y) {
    if (!std::isfinite(y)) continue;
    low = std::isfinite(low) ? std::min(low, y) : y;
    high = std::isfinite(high) ? std::max(high, y) : y;
  }
  if (!std::isfinite(low)) return "set yrange [-1:1]\n";
  const double edge = std::max(kEdge * (high - low), 1e-3);
  return "set yrange [" + text(low - edge) + ":" + text(high + edge) + "]\n";
}

/// Tics of a plan whose axes have one scale: where the path is long and narrow, gnuplot's own choice for the short axis
/// would write one number over the other.
std::string plan_tics(std::span<const StateEstimate> states, std::span<const AidCurve> aids) {
  constexpr double kWide = 480.0, kHigh = 300.0;  // px that the axes have
  constexpr double kApart = 50.0, kBelow = 22.0;  // px that a number needs, along x and along y
  constexpr double kUsual = 6.0;                  // tics that gnuplot chooses about
  Eigen::AlignedBox2d box;
  for (const StateEstimate& one : states) {
    if (one.valid) box.extend(Eigen::Vector2d{one.p_WB.head<2>()});
  }
  for (const AidCurve& aid : aids) {
    for (const Eigen::Vector3d& x : aid.seen->x) {
      if (x.head<2>().allFinite()) box.extend(Eigen::Vector2d{x.head<2>()});
    }
  }
  if (box.isEmpty() || !(box.sizes().maxCoeff() > 0.0)) return "";
  const double scale = std::min(kWide / std::max(box.sizes().x(), 1e-9), kHigh / std::max(box.sizes().y(), 1e-9));
  const auto tics = [&](const char* axis, double size, double needed) {
    if (size * scale > kUsual * needed) return std::string{};
    const double least = needed / scale, decade = std::pow(10.0, std::floor(std::log10(least)));
    const double step = decade * (least <= decade         ? 1.0
                                  : least <= 2.0 * decade ? 2.0
                                  : least <= 5.0 * decade ? 5.0
                                                          : 10.0);
    return "set " + std::string{axis} + " " + text(step) + "\n";
  };
  return tics("xtics", box.sizes().x(), kApart) + tics("ytics", box.sizes().y(), kBelow);
}

}  // namespace

Figure draw_component(const Recording& recording, std::size_t axis, std::span<const AidCurve> aids) {
  Figure figure{.alt = std::string{component_name(axis)} + " over time", .width = 560, .height = 260};
  const Polyline line = estimate(recording, axis);
  std::string plot;
  for (std::size_t i = 0; i < aids.size(); ++i) {
    const std::string name = "a" + std::to_string(i);
    figure.script += dots(name.c_str(), *aids[i].seen, 0, axis % 3, true);
    plot += ", $" + name + dot_style(aids[i].colour);
  }
  figure.script += line_block("e", line) + heading(component_name(axis)) + below("time [s]") + y_range(line) +
                   "plot $e with lines lw 1.4 lc rgb '" + kMeasuredColour + "'" + plot + "\n";
  return figure;
}

// North to the right, east downward: as seen from above, and a tank's longer side lies along the page.
Figure draw_plan(const Recording& recording, std::span<const AidCurve> aids) {
  Figure figure{.alt = "Path seen from above", .width = 560, .height = 380};
  const std::size_t every = std::max<std::size_t>(1, recording.state.size() / (2 * kMostPoints));
  std::string data = "$e << EOD\n";
  for (std::size_t i = 0; i < recording.state.size(); i += every) {
    const StateEstimate& state = recording.state[i];
    data += state.valid ? text(state.p_WB.x()) + " " + text(state.p_WB.y()) + "\n" : "\n";
  }
  std::string plot;
  for (std::size_t i = 0; i < aids.size(); ++i) {
    const std::string name = "a" + std::to_string(i);
    figure.script += dots(name.c_str(), *aids[i].seen, 0, 1, false);
    plot += ", $" + name + dot_style(aids[i].colour);
  }
  figure.script += data + "EOD\n" + heading("y east [m]") + below("x north [m]") + plan_tics(recording.state, aids) +
                   "set size ratio -1\nset yrange [] reverse\nplot $e with lines lw 1 lc rgb '" + kMeasuredColour +
                   "'" + plot + "\n";
  return figure;
}

Figure draw_path(const Recording& recording) {
  Figure figure{.alt = "Path in space", .width = 560, .height = 380};
  const std::size_t every = std::max<std::size_t>(1, recording.state.size() / (2 * kMostPoints));
  std::string data = "$e << EOD\n";
  for (std::size_t i = 0; i < recording.state.size(); i += every) {
    const StateEstimate& state = recording.state[i];
    data += state.valid ? text(state.p_WB.x()) + " " + text(state.p_WB.y()) + " " + text(state.p_WB.z()) + "\n" : "\n";
  }
  figure.script = data + "EOD\nunset lmargin\nunset rmargin\nunset tmargin\nunset bmargin\n" +
                  "set border 4095 lc rgb '#c4c9d0'\nset view 60, 330, 1.1, 1\nset xyplane relative 0.02\n" +
                  "set yrange [] reverse\nset zrange [] reverse\nset xtics offset 0, -0.4\nset xlabel 'x north [m]' " +
                  "offset 0, -0.8\nset ylabel 'y east [m]'\nset zlabel 'z down [m]' rotate by 90\n" +
                  "splot $e with lines lw 1 lc rgb '" + std::string{kAfterColour} + "'\n";
  return figure;
}

Figure draw_parameter(const Recording& recording, std::span<const ModeVisit> visits, const std::string& name,
                      double begin, double end) {
  const Utime origin = trial_origin(recording);
  std::vector<double> t, value, low, high;
  std::string unit;
  for (const ModelEstimate& model : recording.model) {
    const double at = seconds_between(origin, model.utime);
    if (at < begin || at > end) continue;
    for (const NamedValue& p : model.parameters) {
      if (p.name != name) continue;
      t.push_back(at);
      value.push_back(p.value);
      low.push_back(p.value - 2.0 * p.std);
      high.push_back(p.value + 2.0 * p.std);
      unit = p.unit;
    }
  }
  Figure figure{.alt = name + " over time", .width = 380, .height = 220};
  std::string band = "$b << EOD\n";
  const std::size_t every = std::max<std::size_t>(1, t.size() / kMostPoints);
  for (std::size_t i = 0; i < t.size(); i += every)
    band += text(t[i]) + " " + text(low[i]) + " " + text(high[i]) + "\n";
  band += t.empty() ? "NaN NaN NaN\nEOD\n" : "EOD\n";
  // What is drawn is where the estimate ends up: the first seconds, when nothing is known, would flatten the rest. From
  // the trial's begin on zero belongs to the picture, since all begin there.
  double range_low = begin > 0.0 && !t.empty() ? low.back() : 0.0,
         range_high = begin > 0.0 && !t.empty() ? high.back() : 0.0;
  for (std::size_t i = begin > 0.0 ? 0 : t.size() / 8; i < t.size(); ++i) {
    range_low = std::min(range_low, value[i]);
    range_high = std::max(range_high, value[i]);
  }
  const double edge = std::max(kEdge * (range_high - range_low), 1e-3);
  std::string borders;
  int number_of_arrow = 1;
  for (const ModeVisit& visit : visits) {
    if (visit.begun <= begin || visit.begun >= end) continue;
    borders += "set arrow " + std::to_string(number_of_arrow++) + " from first " + text(visit.begun) +
               ", graph 0 to first " + text(visit.begun) + ", graph 1 nohead lc rgb '#b8bec7'\n";
  }
  figure.script = band + line_block("v", decimate(t, value, kMostPoints)) + heading(name + " [" + unit + "]") +
                  below("time [s]") + borders + "set xrange [" + text(begin) + ":" + text(std::max(end, begin + 1.0)) +
                  "]\nset yrange [" + text(range_low - edge) + ":" + text(range_high + edge) +
                  "]\nplot $b with filledcurves fc rgb '#cfe0ef', $v with lines lw 1.8 lc rgb '" + kAfterColour + "'\n";
  return figure;
}

Figure draw_metric(const Recording& recording, const LiveTrialResult& result, const std::string& mode) {
  const Utime origin = trial_origin(recording);
  std::vector<double> t, sum;
  for (const ModelEstimate& model : recording.model) {
    for (const ModeMetric& metric : model.modes) {
      if (metric.mode != mode || !(metric.sum > 0.0)) continue;
      t.push_back(seconds_between(origin, model.utime));
      sum.push_back(metric.sum);
    }
  }
  double threshold = 0.0;
  std::string borders;
  for (const ModeVisit& visit : result.visits) {
    if (visit.mode != mode) continue;
    threshold = visit.threshold;
    borders += "set object " + std::to_string(&visit - result.visits.data() + 1) + " rectangle from first " +
               text(visit.begun) + ", graph 0 to first " + text(visit.ended) +
               ", graph 1 behind fc rgb '#eef3f8' fs solid noborder\n";
  }
  Figure figure{.alt = "Trace of the covariance of " + mode, .width = 380, .height = 220, .left = 58};
  figure.script = line_block("m", decimate(t, sum, kMostPoints)) + heading("trace P, " + mode) + below("time [s]") +
                  borders + "set logscale y\nset format y '%g'\n";
  if (threshold > 0.0) {
    figure.script += "set arrow 1 from graph 0, first " + text(threshold) + " to graph 1, first " + text(threshold) +
                     " nohead dt 2 lc rgb '" + kBeforeColour + "' lw 1.5\n";
  }
  figure.script += "plot $m with lines lw 1.8 lc rgb '" + std::string{kAfterColour} + "'\n";
  return figure;
}

Figure draw_state_error(const Recording& recording, std::size_t axis) {
  const Utime origin = trial_origin(recording);
  const auto k = static_cast<Eigen::Index>(axis);
  std::vector<double> t, error, sigma;
  auto at = recording.state.begin();
  for (const Truth& truth : recording.truth) {
    while (at != recording.state.end() && at->utime < truth.utime) ++at;
    if (at == recording.state.end()) break;
    if (at->utime - truth.utime > kTogether || !at->valid) continue;
    const double dt = seconds_between(truth.utime, at->utime);
    const Eigen::Vector3d dp = at->p_WB - truth.p_WB - dt * (truth.q_WB * truth.nu.head<3>());
    const Eigen::Vector3d dv = at->nu.head<3>() - truth.nu.head<3>() - dt * truth.nu_dot.head<3>();
    t.push_back(seconds_between(origin, truth.utime));
    error.push_back(1e3 * (k < 3 ? dp[k] : dv[k - 3]));
    sigma.push_back(2e3 * at->sigma[k < 3 ? k : k + 3]);
  }
  std::vector<double> minus;
  minus.reserve(sigma.size());
  for (const double s : sigma) minus.push_back(-s);
  const std::string unit = k < 3 ? " [mm]" : " [mm/s]";
  Figure figure{.alt = "Error of the estimate", .width = 380, .height = 200};
  const Polyline line = decimate(t, error, kMostPoints);
  const std::string name = std::string{component_name(axis)};
  figure.script = line_block("u", decimate(t, sigma, kMostPoints)) + line_block("l", decimate(t, minus, kMostPoints)) +
                  line_block("d", line) + heading("error of " + name.substr(0, name.find(' ')) + unit) +
                  below("time [s]") + y_range(line) + "plot $d with lines lw 1 lc rgb '" + kMeasuredColour +
                  "', $u with lines lw 1.4 dt 2 lc rgb '" + kBeforeColour + "', $l with lines lw 1.4 dt 2 lc rgb '" +
                  kBeforeColour + "'\n";
  return figure;
}

}  // namespace fathom::report
