// A reconstructed circle drawn: six figures, and what they show in numbers.
#include "common/report/smoothed_page.hpp"

#include <doctest/doctest.h>

#include <cmath>

namespace fathom::report {
namespace {

/// To port at 0.5 m/s with a radius of 5 m, nose down; one and a half turns.
Recording circle() {
  Recording recording{.name = "a < b"};
  for (int k = 0; k < 960; ++k) {
    const double t = 0.1 * k, psi = -0.1 * t;
    SmoothedState state;
    state.utime = utime_after(1'700'000'000'000'000, t);
    state.p_WB = {5.0 * std::sin(-psi), -5.0 + 5.0 * std::cos(psi), 2.0};
    state.q_WB = Eigen::Quaterniond{rotation_from_euler({0.0, -0.2, psi})};
    state.nu[0] = 0.5;
    state.nu[5] = -0.1;
    recording.smoothed.push_back(state);
    recording.ahrs.push_back({.utime = state.utime, .q_WB = state.q_WB, .has_attitude = true});
  }
  return recording;
}

std::size_t count(const std::string& text, const std::string& what) {
  std::size_t n = 0;
  for (auto at = text.find(what); at != std::string::npos; at = text.find(what, at + 1)) ++n;
  return n;
}

}  // namespace

TEST_CASE(
    "smoothed run drawn: six figures, V a quarter of a turn ahead of U, and centripetal against body acceleration") {
  const Recording recording = circle();
  Smoothing smoothing{.inclinometer_used = false};
  for (const SmoothedState& one : recording.smoothed)
    smoothing.filtered.push_back(
        {.utime = one.utime, .p_WB = one.p_WB + Eigen::Vector3d{0.05, 0.0, 0.0}, .q_WB = one.q_WB});
  const std::string page = smoothed_page(recording, smoothing);
  CHECK(count(page, "<svg") == 6);
  CHECK(count(page, "<figcaption>") == 6);
  CHECK(page.find("a &lt; b") != std::string::npos);
  CHECK(page.find("Position within ") < page.find("</header>"));
  CHECK(page.find("name=\"viewport\"") != std::string::npos);
  CHECK(page.find("V is 90 degrees ahead of U") != std::string::npos);
  CHECK(page.find("5.0 0.0 0.0 cm apart") != std::string::npos);
  // v does not change in a steady circle; u r = 0.5 x -0.1 m/s^2 pulls the vehicle round.
  CHECK(page.find("Its mean is 0.0000 m/s^2, that of the inertial y acceleration -0.0500") != std::string::npos);
  CHECK(page.find("which the filter never saw; rms apart from the smoother 0.0000 rad") != std::string::npos);
  CHECK(page.find("dashed truth") == std::string::npos);
  CHECK(page.find("How its instruments fared") == std::string::npos);  // nobody has told

  smoothing.inclinometer_used = true;
  smoothing.instruments = {{.name = "gyro", .used = 40, .refused = 2, .nis_sum = 44.0}, {.name = "not there"}};
  Album album;
  const std::string section = smoothed_section(recording, smoothing, album);
  CHECK(section.find("which the filter used") != std::string::npos);
  CHECK(section.find("<td>gyro</td><td class=\"n\">40</td><td class=\"n\">2</td><td class=\"n\">0</td><td "
                     "class=\"n\">1.10</td>") != std::string::npos);
  CHECK(section.find("not there") == std::string::npos);
  CHECK(section.find("Position within ") != std::string::npos);
  const std::string before = smoothed_section(recording, {}, album);  // by another program: no filter beside it
  CHECK(before.find("crosses") == std::string::npos);
  CHECK(before.find("4. The pitch inclinometer; rms apart") != std::string::npos);
}

}  // namespace fathom::report
