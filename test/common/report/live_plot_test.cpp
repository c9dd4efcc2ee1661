// The numbers beside a picture are those that it was drawn from.
#include "common/report/live_plot.hpp"

#include <doctest/doctest.h>

#include <limits>

#include "common/report/pictures.hpp"
#include "test/support/diagnosis_fixture.hpp"

using fathom::report::live_plot;
using fathom::report::LivePlot;

namespace {

std::string attribute(const std::string& html, const std::string& name) {
  const std::size_t begin = html.find(name + "=\"") + name.size() + 2;
  return html.substr(begin, html.find('"', begin) - begin);
}

std::string html_of_no_limits() { return live_plot("", {.t = {0.0}, .curves = {{"u", "#000", {1.0}}}}, 1); }

}  // namespace

TEST_CASE("A plot to be looked into holds its samples, gaps and fresh starts") {
  const double gap = std::numeric_limits<double>::quiet_NaN();
  const LivePlot plot{.title = "<u>",
                      .group = "a \"run\"",
                      .t = {0.0, 0.5, 1.0, 1.5, 2.0},
                      .curves = {{"measured", "#000", {1.0, 2.0, gap, 4.0, 5.00004}},
                                 {"before", "#f00", {1.0, 2.0, 3.0, 4.0, 5.0}, true}},
                      .marks = {0.0, 1.0}};
  const std::string html = live_plot("<svg/>", plot, 1);
  CHECK(attribute(html, "data-title") == "&lt;u&gt;");
  CHECK(attribute(html, "data-group") == "a &quot;run&quot;");
  CHECK(attribute(html, "data-t") == "1e-03:0,500,500,500,500");
  // In steps of a thousandth (the range is 4); no line leads from 0.5 s to the fresh start at 1 s.
  CHECK(attribute(html, "data-y") == "1e-03:1000,1000,,2000,1000;1e-03:1000,,2000,1000,1000");
  CHECK(attribute(html, "data-marks") == "1e-03:0,1000");
  CHECK(html.find("<div class=\"still\"><svg/></div>") != std::string::npos);
  CHECK(attribute(live_plot("", plot, 2), "data-y") == "1e-03:1000,,4000;1e-03:,3000,2000");
}

TEST_CASE("The motion to be looked into is that of its picture, in its unit") {
  const auto trace = fathom::test::made_up_trace({.samples = 600}, "run", 1);
  const LivePlot yaw = fathom::report::live_motion(trace, 5, fathom::report::Stretch{100, 300});
  REQUIRE(yaw.t.size() == 200);
  CHECK(yaw.title == "yaw r [deg/s]");
  CHECK(yaw.t.front() == trace.t[100]);
  CHECK(yaw.curves[0].values[7] == doctest::Approx(trace.measured[107][5] * 57.29577951));
  CHECK(yaw.curves[2].values[7] == doctest::Approx(trace.after[107][5] * 57.29577951));
  auto runaway = trace;
  for (std::size_t i = 150; i < 160; ++i) runaway.before[i][5] = 1000.0;
  const LivePlot wild = fathom::report::live_motion(runaway, 5, fathom::report::Stretch{100, 300});
  CHECK(wild.ceiling < 10.0 * yaw.ceiling);  // the measurement is not squeezed flat
  CHECK(attribute(live_plot("", wild, 1), "data-ceiling") != "");
  CHECK(attribute(html_of_no_limits(), "data-ceiling").empty());
  CHECK(yaw.marks == std::vector<double>{trace.t[100], trace.t[200]});
}
