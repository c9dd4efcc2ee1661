// Rows of a regression: what a log must hold, unequal steps, gaps, and states that the smoother is not sure of.
#include "common/identification/regression/manoeuvre_rows.hpp"

#include <doctest/doctest.h>

#include <limits>
#include <string>
#include <vector>

#include "common/base/error.hpp"
#include "test/support/virtual_dive.hpp"

namespace fathom::identification {

TEST_CASE("regress: what is wrong with a log is said in one line") {
  const model::Vehicle vehicle = test::vehicle_from_repository("pap104_half");
  const auto said = [&](const Recording& recording, double rate) -> std::string {
    try {
      static_cast<void>(rows_of(recording, vehicle, rate));
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  };
  Recording recording;
  recording.name = "run";
  for (int k = 0; k < 500; ++k) {
    recording.smoothed.push_back({.utime = 1'000'000 + 20'000 * static_cast<Utime>(k)});
    recording.loads.push_back({.utime = recording.smoothed.back().utime, .load = std::vector<double>(8, 0.0)});
  }
  CHECK(said(recording, 10.0).empty());
  CHECK(said(recording, 0.5) == "run: 5 rows of 2 s; regression needs 20 at least, so a higher --rate or a longer run");
  auto cells = recording;
  for (auto& one : cells.loads) one.load.pop_back();
  CHECK(said(cells, 10.0) == "run: LOADS has 7 cells and the vehicle file 8");
  auto none = recording;
  none.loads.clear();
  CHECK(said(none, 10.0).find("neither LOADS nor forces in THRUSTERS") != std::string::npos);
  auto unknown = recording;
  for (auto& one : unknown.smoothed) one.sigma[7] = std::numeric_limits<double>::quiet_NaN();
  CHECK(said(unknown, 10.0) ==
        "run: SMOOTHED has less than three states whose errors are stated and small enough to believe them");
}

TEST_CASE("regress: unequal steps are averaged by time, and a gap parts a run into stretches") {
  const model::Vehicle vehicle = test::vehicle_from_repository("pap104_half");
  Recording recording;
  recording.name = "run";
  for (int k = 0; k < 1000; ++k) {
    if (k % 7 == 3 || k % 5 == 1 || (k > 400 && k < 460)) continue;
    SmoothedState state{.utime = 1'000'000 + 20'000 * static_cast<Utime>(k)};
    state.nu[0] = 0.02 * k;  // m/s: tells the time
    recording.smoothed.push_back(state);
    recording.loads.push_back({.utime = state.utime, .load = std::vector<double>(8, 1.0)});
  }
  const ManoeuvreRows rows = rows_of(recording, vehicle, 5.0);
  REQUIRE(rows.stretches.size() == 2);
  for (const auto& stretch : rows.stretches) {
    for (std::size_t n = 1; n < stretch.size(); ++n) {
      CHECK(stretch[n].nu[0] - stretch[n - 1].nu[0] == doctest::Approx(rows.dt).epsilon(0.15));
      CHECK(stretch[n].known[0] == doctest::Approx(4.0));  // two thrusters, umbilical x, chain x
    }
  }
}

TEST_CASE("regress: where the smoother is much less sure than mostly, a run is no witness") {
  const model::Vehicle vehicle = test::vehicle_from_repository("pap104_half");
  Recording recording;
  recording.name = "run";
  for (int k = 0; k < 1000; ++k) {
    SmoothedState state{.utime = 1'000'000 + 20'000 * static_cast<Utime>(k)};
    state.sigma.setConstant(0.01);
    state.sigma.head<3>().setConstant(k < 500 ? 0.1 : 9.0);  // m: no force depends on where the run is
    if (k >= 950) state.sigma[7] = 0.03;                     // m/s: sway at the end, where nothing comes after
    if (k >= 400 && k < 450) state.sigma[13] = 0.021;        // m/s^2: aids were lost
    if (k >= 600 && k < 650) state.sigma[13] = 0.019;
    state.nu[1] = state.sigma.tail<15>().maxCoeff() > 0.02 ? 100.0 : 0.0;
    recording.smoothed.push_back(state);
    recording.loads.push_back({.utime = state.utime, .load = std::vector<double>(8, 1.0)});
  }
  const ManoeuvreRows rows = rows_of(recording, vehicle, 10.0);
  CHECK(rows.unsure == doctest::Approx(2.0));  // s: a hundred states of 20 ms
  REQUIRE(rows.stretches.size() == 2);
  for (const auto& stretch : rows.stretches) {
    for (const auto& row : stretch) CHECK(row.nu[1] == 0.0);
  }
  for (SmoothedState& one : recording.smoothed) one.sigma.setZero();  // another program's, which states nothing
  CHECK(rows_of(recording, vehicle, 10.0).unsure == 0.0);
}

}  // namespace fathom::identification
