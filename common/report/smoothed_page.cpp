#include "common/report/smoothed_page.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <cstdio>
#include <functional>
#include <numbers>
#include <vector>

#include "common/base/spatial.hpp"
#include "common/base/statistics.hpp"
#include "common/report/plot.hpp"
#include "common/report/text.hpp"

namespace fathom::report {
namespace {

constexpr std::size_t kMostLine = 600, kMostCrosses = 80;  // points of a curve
constexpr double kConverged = 30.0;                        // s after which filter and smoother are compared
constexpr double kTurn = 2.0 * std::numbers::pi;

struct Point {
  double x{}, y{};
};

/// One curve's points and how they are drawn.
struct Curve {
  const char* style;
  std::vector<Point> points;
};

constexpr const char* kLine = "with lines lw 2 lc rgb '#22262b'";
constexpr const char* kCross = "with points pt 2 ps 0.8 lw 2 lc rgb '#e07b00'";
constexpr const char* kTruth = "with lines lw 1.5 dt 2 lc rgb '#2a7a3b'";
constexpr const char* kOther = "with lines lw 2 dt 4 lc rgb '#1f6fb2'";

Figure drawn(const std::string& alt, const std::vector<Curve>& curves, const std::string& x, const std::string& y,
             const std::string& more = "") {
  Figure f{.alt = alt, .width = 560, .height = 360};
  f.left = 80;
  std::string plot;
  for (std::size_t i = 0; i < curves.size(); ++i) {
    if (curves[i].points.empty()) continue;
    const std::string name = "$c" + std::to_string(i);
    f.script += name + " << EOD\n";
    for (const Point& one : curves[i].points) f.script += std::to_string(one.x) + " " + std::to_string(one.y) + "\n";
    f.script += "EOD\n";
    plot += (plot.empty() ? "plot " : ", ") + name + " " + curves[i].style;
  }
  f.script += more + "set xlabel '" + x + "' offset 0, 0.6\nset ylabel '" + y + "'\n" + plot + "\n";
  return f;
}

template <class Stream>
std::vector<Point> thinned(const Stream& stream, std::size_t most, const std::function<Point(std::size_t)>& at) {
  std::vector<Point> points;
  const std::size_t every = std::max<std::size_t>(1, stream.size() / most);
  for (std::size_t k = 0; k < stream.size(); k += every) points.push_back(at(k));
  return points;
}

double pitch(const Eigen::Quaterniond& q_WB) { return euler_from_rotation(q_WB.toRotationMatrix()).y(); }

std::string number(const char* format, double a, double b = 0.0, double c = 0.0) {
  char text[160];
  std::snprintf(text, sizeof text, format, a, b, c);
  return text;
}

/// By how much of a turn V goes before U while the vehicle circles; nothing of less than a whole turn.
std::string phase_of(const std::vector<SmoothedState>& states) {
  std::complex<double> U, V;
  double yaw = 0.0, before = 0.0;
  for (std::size_t k = 0; k < states.size(); ++k) {
    const double now = euler_from_rotation(states[k].q_WB.toRotationMatrix()).z();
    if (k > 0) yaw += wrap_angle(now - before);
    before = now;
    const Eigen::Vector3d v_W = states[k].q_WB * states[k].nu.head<3>();
    U += v_W.x() * std::polar(1.0, -yaw);
    V += v_W.y() * std::polar(1.0, -yaw);
  }
  if (std::abs(yaw) < kTurn) return "";
  const double apart = wrap_angle(std::arg(V) - std::arg(U)) * (yaw > 0.0 ? 1.0 : -1.0);
  return number(" In %.1f turns V is %.0f degrees ahead of U.", std::abs(yaw) / kTurn, 360.0 / kTurn * apart);
}

std::string instruments_of(const std::vector<estimation::InnovationStatistics>& instruments) {
  std::string rows;
  for (const estimation::InnovationStatistics& one : instruments) {
    if (one.used + one.refused + one.dropped == 0) continue;
    rows += "<tr>" + cell(escape(one.name)) + cell(std::to_string(one.used), "n") +
            cell(std::to_string(one.refused), "n") + cell(std::to_string(one.dropped), "n") +
            cell(number("%.2f", one.nis()), "n") + "</tr>\n";
  }
  if (rows.empty()) return "";
  return "<details><summary>How its instruments fared</summary>\n<table>" +
         heading_cells({"instrument", "used", "refused", "not heard", "NIS"}, {1, 2, 3, 4}) + rows +
         "</table>\n<p class=\"soft small\">NIS: innovations squared over what is stated of them; 1 where "
         "the noise is as stated.</p></details>\n";
}

/// "Position within .. m, velocity within .. m/s".
std::string sureness(const std::vector<SmoothedState>& states) {
  std::vector<double> place, speed;  // m, m/s: standard deviations of the worst component
  for (const SmoothedState& one : states) {
    place.push_back(one.sigma.head<3>().maxCoeff());
    speed.push_back(one.sigma.segment<3>(6).maxCoeff());
  }
  return "Position within " + number("%.2g m", kNormal95 * median(place)) + ", velocity within " +
         number("%.2g m/s", kNormal95 * median(speed));
}
constexpr const char* kSureness = "As the smoother states it: 95 %, on the worst axis, at half of the instants better.";

std::string section_of(const Recording& recording, const std::string& lead, const Smoothing& smoothing, Album& album) {
  const std::vector<StateEstimate>& filtered = smoothing.filtered;
  const std::vector<SmoothedState>& s = recording.smoothed;
  const std::vector<Truth>& truth = recording.truth;
  const Utime origin = s.empty() ? Utime{} : s.front().utime;
  const auto t = [origin](Utime utime) { return seconds_between(origin, utime); };
  /// A curve of the smoother, the filter and the truth: what `y` tells of position, attitude and time.
  using Look = std::function<Point(double, const Eigen::Vector3d&, const Eigen::Quaterniond&)>;
  const auto three = [&](const Look& look) {
    return std::vector<Curve>{
        {kTruth, thinned(truth, kMostLine,
                         [&](std::size_t k) { return look(t(truth[k].utime), truth[k].p_WB, truth[k].q_WB); })},
        {kLine, thinned(s, kMostLine, [&](std::size_t k) { return look(t(s[k].utime), s[k].p_WB, s[k].q_WB); })},
        {kCross, thinned(filtered, kMostCrosses, [&](std::size_t k) {
           return look(t(filtered[k].utime), filtered[k].p_WB, filtered[k].q_WB);
         })}};
  };
  std::vector<Curve> incline;
  double held = 0.0, square = 0.0;
  {
    std::vector<Point> seen;
    std::size_t next = 0;
    for (const Ahrs& one : recording.ahrs) {
      if (!one.has_attitude) continue;
      seen.push_back({t(one.utime), pitch(one.q_WB)});
      while (next < s.size() && s[next].utime < one.utime) ++next;
      if (next == s.size() || s[next].utime != one.utime) continue;
      square += std::pow(pitch(one.q_WB) - pitch(s[next].q_WB), 2);
      held += 1.0;
    }
    incline.push_back({kOther, thinned(seen, kMostLine, [&](std::size_t k) { return seen[k]; })});
  }
  const auto world = [&](std::size_t k) { return Eigen::Vector3d(s[k].q_WB * s[k].nu.head<3>()); };
  const std::vector<Figure> figures{drawn("Plan view", three([](double, const auto& p, const auto&) {
                                            return Point{p.x(), p.y()};
                                          }),
                                          "X (north) [m]", "Y (east) [m]", "set yrange [] reverse\n"),
                                    drawn("Y over time", three([](double now, const auto& p, const auto&) {
                                            return Point{now, p.y()};
                                          }),
                                          "time [s]", "Y [m]"),
                                    drawn("Pitch", three([](double now, const auto&, const auto& q) {
                                            return Point{now, pitch(q)};
                                          }),
                                          "time [s]", "pitch [rad]"),
                                    drawn("Inclinometer", incline, "time [s]", "pitch [rad]"),
                                    drawn("Velocities in the world",
                                          {{kLine, thinned(s, kMostLine,
                                                           [&](std::size_t k) {
                                                             return Point{t(s[k].utime), world(k).x()};
                                                           })},
                                           {kOther, thinned(s, kMostLine,
                                                            [&](std::size_t k) {
                                                              return Point{t(s[k].utime), world(k).y()};
                                                            })}},
                                          "time [s]", "velocity [m/s]"),
                                    drawn("Sway acceleration",
                                          {{kTruth, thinned(truth, kMostLine,
                                                            [&](std::size_t k) {
                                                              return Point{t(truth[k].utime), truth[k].nu_dot[1]};
                                                            })},
                                           {kLine, thinned(s, kMostLine,
                                                           [&](std::size_t k) {
                                                             return Point{t(s[k].utime), s[k].nu_dot[1]};
                                                           })}},
                                          "time [s]", "derivative of v [m/s^2]")};

  Eigen::Vector3d apart = Eigen::Vector3d::Zero();
  double late = 0.0, body = 0.0, inertial = 0.0, n = 0.0;
  for (std::size_t k = 0; k < s.size(); ++k) {
    const Vector6d& nu = s[k].nu;
    body += s[k].nu_dot[1];
    inertial += s[k].nu_dot[1] + nu[5] * nu[0] - nu[3] * nu[2];
    n += 1.0;
    if (t(s[k].utime) < kConverged || k >= filtered.size()) continue;
    apart += (s[k].p_WB - filtered[k].p_WB).cwiseAbs();
    late += 1.0;
  }
  const std::string keys = std::string{"line smoother"} + (filtered.empty() ? "" : ", crosses filter") +
                           (truth.empty() ? "" : ", dashed truth");
  const std::string apart_words =
      number("rms apart from the smoother %.4f rad", std::sqrt(square / std::max(held, 1.0)));
  const std::string witness = held == 0.0                           ? ", which nobody recorded"
                              : !smoothing.inclinometer_used        ? "; " + apart_words
                              : smoothing.inclinometer_used.value() ? ", which the filter used; " + apart_words
                                                                    : ", which the filter never saw; " + apart_words;
  const std::string captions[] = {
      "1. Plan view, from above: " + keys + ".",
      "2. Y: " + keys + "." +
          (late > 0.0 ? number(" After 30 s the two are %.1f %.1f %.1f cm apart on average (X Y Z).",
                               100 * apart.x() / late, 100 * apart.y() / late, 100 * apart.z() / late)
                      : ""),
      "3. Pitch: " + keys + ".",
      "4. The pitch inclinometer" + witness + ".",
      "5. Velocities in the world: line U, blue V." + phase_of(s),
      "6. Derivative of v in the body: line smoother" + std::string{truth.empty() ? "" : ", dashed truth"} + "." +
          (n > 0.0
               ? number(" Its mean is %.4f m/s^2, that of the inertial y acceleration %.4f.", body / n, inertial / n)
               : "")};
  std::string html = "<section><h2>" + escape(recording.name) + "</h2>\n" + lead + "<div class=\"grid pair\">\n";
  for (std::size_t i = 0; i < figures.size(); ++i) html += figure(album.place(figures[i]), captions[i]);
  return html + "</div>\n" + instruments_of(smoothing.instruments) + "</section>\n";
}

}  // namespace

std::string smoothed_section(const Recording& recording, const Smoothing& smoothing, Album& album) {
  const std::string lead = recording.smoothed.empty() ? ""
                                                      : "<p>" + sureness(recording.smoothed) +
                                                            ". <span class=\"soft\">" + kSureness + "</span></p>\n";
  return section_of(recording, lead, smoothing, album);
}

std::string smoothed_page(const Recording& recording, const Smoothing& smoothing) {
  const auto& s = recording.smoothed;
  const std::string title = "How the vehicle moved: " + recording.name;
  std::string html =
      page_head(title) + "<header><h1>" + escape(title) +
      "</h1>\n<p class=\"soft\">A recorded run, smoothed: each state rests on what was measured before and "
      "after it.</p>\n";
  if (!s.empty())
    html += "<div class=\"badge adequate\">" + sureness(s) + "</div>\n<p class=\"lead\">" + kSureness + "</p>\n" +
            "<div class=\"tiles\">" +
            tile(number("%.4g s", seconds_between(s.front().utime, s.back().utime)), "smoothed") +
            tile(std::to_string(s.size()), "states") +
            tile(std::to_string(smoothing.filtered.size()), "states of the filter beside them") + "</div>\n";
  html +=
      "<p class=\"note\"><b>Next.</b> Forces from this motion: fathom regress SMOOTHED.lcmlog --vehicle "
      "V.yaml.</p></header>\n";
  Album album;
  html += section_of(recording, "", smoothing, album);
  return album.fill(html + version_line() + "</main></body></html>\n", "gnuplot");
}

}  // namespace fathom::report
