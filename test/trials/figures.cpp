// Figures 1 to 6 of Pereira and Duncan from a simulated circle, as one page.
#include <cmath>
#include <cstdio>

#include "common/base/spatial.hpp"
#include "common/estimation/smoothing/trial_smoother.hpp"
#include "common/report/plot.hpp"
#include "common/tables/writer.hpp"
#include "test/trials/trials.hpp"

namespace fathom::trials {
namespace {

constexpr std::size_t kEvery = 10;                   // samples per point of a line
constexpr double kSteady = 36.0, kSteadyEnd = 90.0;  // s

struct Curve {
  std::string name;
  std::string text;
  void add(double x, double y) { text += std::to_string(x) + " " + std::to_string(y) + "\n"; }
  [[nodiscard]] std::string block() const { return "$" + name + " << EOD\n" + text + "EOD\n"; }
};

constexpr const char* kLine = " with lines lw 2 lc rgb '#22262b'";
constexpr const char* kCross = " with points pt 2 ps 0.5 lc rgb '#e07b00'";
constexpr const char* kDash = " with lines lw 2 dt 2 lc rgb '#e07b00'";

report::Figure figure(const std::string& alt, const Curve& a, const char* style_a, const Curve& b, const char* style_b,
                      const std::string& x, const std::string& y, const std::string& more = "") {
  report::Figure f{.alt = alt, .width = 560, .height = 360};
  f.script = a.block() + b.block() + more + "set xlabel '" + x + "' offset 0, 0.6\nset ylabel '" + y + "'\nplot $" +
             a.name + style_a + ", $" + b.name + style_b + "\n";
  return f;
}

}  // namespace

void figures(const std::string& folder, unsigned seed) {
  const Setup s = setup();
  const auto trial =
      test::record_trial(s.vehicle, s.instruments, {.manoeuvre = model::manoeuvre_preset("circle"), .seed = seed});
  const auto result = estimation::smooth(trial.recording, s.instruments);
  Curve track_f{"tf"}, track_s{"ts"}, y_f{"yf"}, y_s{"ys"}, pitch_f{"pf"}, pitch_s{"ps"}, incline{"in"}, none{"no"},
      U{"u"}, V{"v"}, a_s{"as"}, a_f{"af"};
  double sum = 0.0, largest = 0.0, inertial = 0.0, n = 0.0, held_out = 0.0, held = 0.0;
  Eigen::Vector3d apart = Eigen::Vector3d::Zero();
  double late = 0.0;
  double first_U = 0.0, first_V = 0.0, peak_U = -1.0, peak_V = -1.0;
  for (std::size_t k = 0; k < result.smoothed.size(); ++k) {
    const SmoothedState& sm = result.smoothed[k];
    const StateEstimate& fi = result.filtered[k];
    const double t = trial.flight[k].t;
    const Eigen::Vector3d euler = euler_from_rotation(sm.q_WB.toRotationMatrix());
    const Eigen::Vector3d v_W = sm.q_WB * sm.nu.head<3>();
    if (trial.recording.ahrs[k].has_attitude) {
      const double seen = euler_from_rotation(trial.recording.ahrs[k].q_WB.toRotationMatrix()).y();
      incline.add(t, seen);
      held_out += std::pow(seen - euler.y(), 2);
      held += 1.0;
    }
    if (t > kSteady && t < kSteadyEnd) {
      sum += sm.nu_dot[1];
      largest = std::max(largest, std::abs(sm.nu_dot[1]));
      inertial += sm.nu_dot[1] + sm.nu[5] * sm.nu[0] - sm.nu[3] * sm.nu[2];
      n += 1.0;
    }
    if (t > 30.0) {
      apart += (sm.p_WB - fi.p_WB).cwiseAbs();
      late += 1.0;
    }
    if (t > 36.0 && t < 36.0 + 63.0) {
      if (v_W.x() > peak_U) peak_U = v_W.x(), first_U = t;
      if (v_W.y() > peak_V) peak_V = v_W.y(), first_V = t;
    }
    if (k % kEvery != 0) continue;
    track_f.add(fi.p_WB.x(), fi.p_WB.y());
    track_s.add(sm.p_WB.x(), sm.p_WB.y());
    y_f.add(t, fi.p_WB.y());
    y_s.add(t, sm.p_WB.y());
    pitch_f.add(t, euler_from_rotation(fi.q_WB.toRotationMatrix()).y());
    pitch_s.add(t, euler.y());
    U.add(t, v_W.x());
    V.add(t, v_W.y());
    a_s.add(t, sm.nu_dot[1]);
    a_f.add(t, trial.flight[k].nu_dot[1]);
  }
  none.add(0.0, 0.0);
  const std::vector<std::string> pictures = report::render(
      {figure("Plan view", track_f, kCross, track_s, kLine, "X (north) [m]", "Y (east) [m]",
              "set xrange [-7:19]\nset yrange [13:-2]\n"),
       figure("Y over time", y_f, kCross, y_s, kLine, "time [s]", "Y [m]"),
       figure("Pitch", pitch_f, kCross, pitch_s, kLine, "time [s]", "pitch [rad]", "set yrange [-0.45:0.05]\n"),
       figure("Inclinometer", incline, kLine, none, " with dots", "time [s]", "pitch [rad]",
              "set yrange [-0.45:0.05]\n"),
       figure("Velocities", U, kLine, V, kDash, "time [s]", "velocity [m/s]"),
       figure("Sway acceleration", a_f, kDash, a_s, kLine, "time [s]", "derivative of v [m/s^2]")});
  const char* captions[] = {"1. Plan view, from above: crosses filter, line smoother.",
                            "2. Y: crosses filter, line smoother.",
                            "3. Pitch: crosses filter, line smoother.",
                            "4. The pitch inclinometer, which the filter never saw.",
                            "5. Velocities in the world: line U, dashed V.",
                            "6. Derivative of v in the body: line smoother, dashed truth."};
  std::string page =
      "<!doctype html><meta charset='utf-8'><title>Circle</title><style>body{font-family:sans-serif;max-width:1160px;"
      "margin:auto}div{display:grid;grid-template-columns:1fr 1fr;gap:8px}figure{margin:0}figcaption{font-size:13px}"
      "</style><h1>A simulated circle to port</h1><div>\n";
  for (std::size_t i = 0; i < pictures.size(); ++i) {
    page += "<figure>" + pictures[i] + "<figcaption>" + captions[i] + "</figcaption></figure>\n";
  }
  tables::write_file(folder + "/figures.html", page + "</div>\n");
  apart /= late;
  std::printf("%s/figures.html\n", folder.c_str());
  std::printf("mean |smoother - filter| after 30 s: X %.1f Y %.1f Z %.1f cm (paper: 5.2 10.1 5.5)\n", 100 * apart.x(),
              100 * apart.y(), 100 * apart.z());
  std::printf("pitch, smoother against inclinometer: rms %.4f rad; at the start %.3f rad (paper: -0.2)\n",
              std::sqrt(held_out / held), euler_from_rotation(result.smoothed.front().q_WB.toRotationMatrix()).y());
  std::printf(
      "36 to 90 s: derivative of v mean %.4f, largest %.3f m/s^2 (paper: -0.002, 0.05); inertial y acceleration mean "
      "%.4f m/s^2 (u r)\n",
      sum / n, largest, inertial / n);
  std::printf("peaks within a turn: V at %.1f s, U at %.1f s\n", first_V, first_U);
}

}  // namespace fathom::trials
