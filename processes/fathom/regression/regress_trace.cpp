#include "processes/fathom/regression/regress_trace.hpp"

#include <algorithm>
#include <cstdio>
#include <utility>

#include "common/base/motions.hpp"
#include "common/report/pictures.hpp"
#include "common/report/text.hpp"
#include "common/samples/estimates.hpp"

namespace fathom::tool {
namespace {

using identification::PullTrace;
using identification::TracedPull;
using report::cell;

constexpr Eigen::Index kMostDrawn = 600;  // points of a curve

const char* letter(const TracedPull& one) { return model::kAxisNames[static_cast<std::size_t>(one.axis)]; }

std::string gained(const TracedPull& one) {
  std::string names;
  for (const std::string& name : one.gained) names += (names.empty() ? "" : ", ") + name;
  return names;
}

/// Residual without and with the force, and the force about its mean: all runs one after the other.
report::Figure drawn(const TracedPull& one) {
  Eigen::Index rows = 0;
  double mean = 0.0;
  for (const PullTrace& trace : one.traces) {
    rows += trace.pull.size();
    mean += trace.pull.sum();
  }
  mean /= static_cast<double>(std::max<Eigen::Index>(rows, 1));
  const Eigen::Index every = std::max<Eigen::Index>(1, rows / kMostDrawn);
  report::Figure figure{.alt = std::string{"Residual of "} + letter(one) + " over time", .width = 560, .height = 240};
  figure.left = 70;
  figure.script = "$r << EOD\n";
  double begin = 0.0;  // s, of a stretch
  for (const PullTrace& trace : one.traces) {
    for (Eigen::Index i = 0; i < trace.pull.size(); i += every) {
      figure.script += report::number(begin + static_cast<double>(i) * trace.dt, 6);
      for (const double value : {trace.before[i], trace.after[i], trace.pull[i] - mean})
        figure.script += " " + report::number(value, 5);
      figure.script += "\n";
    }
    figure.script += "\n";  // an empty line: no curve goes on over it
    begin += static_cast<double>(trace.pull.size()) * trace.dt;
  }
  const auto curve = [](int column, const char* colour, const char* more) {
    return "$r using 1:" + std::to_string(column) + " with lines lw 1.6 lc rgb '" + colour + "'" + more;
  };
  figure.script += "EOD\nset xlabel 'time [s]' offset 0, 0.6\nset ylabel '" + std::string{letter(one)} +
                   (one.axis < 3 ? " [N]" : " [N m]") + "'\nplot " + curve(4, report::kMeasuredColour, " dt 2") + ", " +
                   curve(2, report::kBeforeColour, "") + ", " + curve(3, report::kAfterColour, "") + "\n";
  return figure;
}

}  // namespace

void print_trace(std::span<const TracedPull> traced) {
  std::printf("\nWhence the residual comes: had a force not been measured, and with it subtracted\n");
  std::printf("%-12s %-5s %11s %11s %14s %14s  %s\n", "force", "axis", "rms without", "with", "phi without", "with",
              "of the variance without; false terms");
  for (const auto& one : traced) {
    const std::string false_terms = one.gained.empty() ? "" : "; " + gained(one);
    std::printf("%-12s %-5s %11.3g %11.3g %14.3f %14.3f  %.0f %%%s\n", identification::kPulls[one.pull], letter(one),
                one.before, one.after, one.phi_before, one.phi_after, 100.0 * one.correlation * one.correlation,
                false_terms.c_str());
  }
}

std::string trace_section(std::span<const TracedPull> traced, report::Album& album) {
  if (traced.empty()) return "";
  std::string rows, pictures;
  for (const TracedPull& one : traced) {
    const std::string of = std::string{identification::kPulls[one.pull]} + " on " + letter(one);
    rows +=
        "<tr>" + cell(of, "k") + cell(report::number(one.before, 3), "n") + cell(report::number(one.after, 3), "n") +
        cell(report::number(one.phi_before, 3), "n") + cell(report::number(one.phi_after, 3), "n") +
        cell(report::percent(one.correlation * one.correlation), "n") + cell(report::escape(gained(one))) + "</tr>\n";
    pictures += report::figure(album.place(drawn(one)),
                               "The " + of +
                                   ": residual had it not been measured (orange), with it subtracted (blue), "
                                   "and the force itself about its mean (dashed).");
  }
  return "<section><h2>Whence the residual comes</h2>\n<p class=\"soft\">Terms are selected once without a measured "
         "force and once with it subtracted. Residuals root mean square, in N and N m.</p>\n<table>" +
         report::heading_cells({"force", "residual without it", "with it", "AR(1) without", "with",
                                "of the variance without it", "selected falsely without it"},
                               {1, 2, 3, 4, 5}) +
         rows + "</table>\n<details><summary>Residuals and forces over time</summary><div class=\"grid pair\">\n" +
         pictures + "</div></details></section>\n";
}

}  // namespace fathom::tool
