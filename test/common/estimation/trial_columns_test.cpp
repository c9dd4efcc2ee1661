// Measured columns on a trial's grid: straight lines, products, bearings, and what cannot be used.
#include "common/estimation/trial_columns.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "common/base/error.hpp"

using namespace fathom;
using namespace fathom::estimation;

namespace {

constexpr double kRounding = 1e-9, kPi = std::numbers::pi;

/// A value each second from `first` to `last`.
void tell(Recording& recording, const std::string& name, const std::string& unit, int first, int last, auto value,
          const std::string& quantity = "") {
  for (int k = first; k <= last; ++k)
    recording.signals.push_back(
        {.utime = utime_after(0, k), .name = name, .quantity = quantity, .unit = unit, .value = value(k)});
}

Trial columns_of(const Recording& recording, const std::string& candidate, double heading = 0.0) {
  model::Vehicle vehicle;
  model::add_candidate(candidate, vehicle.candidates);
  Trial trial{.name = recording.name, .dt = 0.5, .observed = {.attitude = true}};
  for (int k = 0; k < 21; ++k) {
    trial.t.push_back(0.5 * k);
    trial.q_WB.emplace_back(Eigen::AngleAxisd{heading, Eigen::Vector3d::UnitZ()});
  }
  add_columns(recording, 0, vehicle, trial);
  return trial;
}

std::string complaint(const Recording& recording, const std::string& candidate) {
  try {
    static_cast<void>(columns_of(recording, candidate));
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

}  // namespace

TEST_CASE("columns: of the step that begins at a sample, along straight lines, multiplied with their units") {
  Recording recording{.name = "run"};
  tell(recording, "wind", "m/s", 0, 10, [](int k) { return 1.0 * k; });
  tell(recording, "tension", "N", 0, 10, [](int) { return -3.0; });
  for (int k = 0; k <= 10; ++k) recording.battery.push_back({.utime = utime_after(0, k), .voltage = 12.0});
  const Trial trial = columns_of(recording, "wind^2*|tension|*voltage");
  REQUIRE(trial.columns.size() == trial.size());
  CHECK(trial.columns[3][0] == doctest::Approx(1.75 * 1.75 * 3.0 * 12.0).epsilon(kRounding));
  CHECK(trial.columns[3][1] == 0.0);
  CHECK(trial.columns[20][0] == doctest::Approx(10.0 * 10.0 * 3.0 * 12.0).epsilon(kRounding));
  CHECK(trial.column_units == std::vector<std::string>{"(m/s)^2 N V"});
  CHECK(columns_of(recording, "wind").columns[3][0] == doctest::Approx(1.75).epsilon(kRounding));
}

TEST_CASE("columns: a bearing goes the shorter way, is turned from where the wind comes, and from the bow to north") {
  Recording recording{.name = "run"};
  tell(recording, "wind", "m/s", 0, 10, [](int) { return 2.0; });
  // Across north: 350 and 10 degrees in turn.
  tell(recording, "way", "rad", 0, 10, [](int k) { return (k % 2 == 0 ? 350.0 : 10.0) * kPi / 180.0; });
  tell(
      recording, "from", "rad", 0, 10, [](int) { return 0.3; }, "wind_from_true");
  tell(
      recording, "at_bow", "rad", 0, 10, [](int) { return 0.3; }, "wind_from_apparent");
  CHECK(std::cos(columns_of(recording, "wind @ way").columns[1][1]) == doctest::Approx(std::cos(kPi / 36.0)));
  CHECK(std::cos(columns_of(recording, "wind @ way").columns[0][1]) == doctest::Approx(std::cos(kPi / 36.0)));
  CHECK(columns_of(recording, "wind @ from", 1.0).columns[4][1] == doctest::Approx(0.3 + kPi));
  CHECK(columns_of(recording, "wind @ at_bow", 1.0).columns[4][1] == doctest::Approx(1.3 + kPi));
}

TEST_CASE("columns: what is missing, no number, too short or no bearing is told in a line") {
  Recording recording{.name = "run"};
  tell(recording, "wind", "m/s", 0, 10, [](int) { return 2.0; });
  tell(recording, "late", "m/s", 8, 10, [](int) { return 2.0; });
  tell(recording, "way", "gon", 0, 10, [](int) { return 2.0; });
  tell(recording, "bad", "m", 0, 10, [](int k) { return k == 4 ? std::numeric_limits<double>::quiet_NaN() : 2.0; });
  CHECK(complaint(recording, "winds") == "run: no column 'winds', which is a candidate; it has bad, late, way, wind");
  CHECK(complaint(recording, "bad") ==
        "run: at 4.000 s the column 'bad', a candidate, is no number; leave such rows out of the recording");
  CHECK(complaint(recording, "late").starts_with("run: the column 'late', a candidate, tells of 2 s of 10 s"));
  CHECK(complaint(recording, "wind @ way").starts_with("run: the column 'way', a candidate's bearing, is in 'gon'"));
  model::Candidate candidate = model::parse_candidate("wind*rain");
  CHECK(missing_column(recording, candidate) == "rain");
  candidate = model::parse_candidate("wind @ way");
  CHECK(missing_column(recording, candidate).empty());
}
