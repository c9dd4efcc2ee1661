// What drove the vehicle, put on a trial's grid: straight lines, what was held, and means of what came faster.
#include "common/estimation/trial_input.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/base/error.hpp"

using namespace fathom;
using namespace fathom::estimation;

namespace {

constexpr double kRounding = 1e-9;

/// A thruster whose force counts the rows, one every `step` [s] from `first` [s] on.
Recording rows(double first, double step, int count) {
  Recording recording;
  recording.name = "rows";
  for (int k = 0; k < count; ++k) {
    recording.thrusters.push_back({.utime = utime_after(0, first + step * k), .force = {static_cast<double>(k)}});
  }
  return recording;
}

model::Vehicle with_thrusters(int count) {
  model::Vehicle vehicle;
  vehicle.allocation.setOnes(6, count);
  return vehicle;
}

Trial on_grid(const Recording& recording, double dt, int count, const Averaging& averaging = {},
              const model::Vehicle& vehicle = with_thrusters(1)) {
  Trial trial{.name = recording.name, .dt = dt};
  for (int k = 0; k < count; ++k) trial.t.push_back(dt * k);
  add_input(recording, 0, {}, vehicle, averaging, trial);
  return trial;
}

}  // namespace

TEST_CASE("trial input: rows slower than the grid lie on straight lines, and hold until the next one") {
  const Trial trial = on_grid(rows(0.0, 0.2, 5), 0.1, 9);
  CHECK(trial.input_step == doctest::Approx(0.2));
  CHECK_FALSE(trial.input_averaged);
  for (std::size_t k = 0; k < trial.t.size(); ++k) {
    CAPTURE(k);
    const double row = std::floor(0.5 * static_cast<double>(k));
    CHECK(std::abs(trial.input[k][0] - 0.5 * static_cast<double>(k)) < kRounding);
    CHECK(std::abs(trial.held[k][0] - row) < kRounding);
    CHECK(std::abs(trial.told[k][0] - std::min(4.0, row + 1.0)) < kRounding);
  }
}

TEST_CASE("trial input: a step of the grid that a row falls into holds the mean of both") {
  const Trial trial = on_grid(rows(0.05, 0.2, 5), 0.1, 8);
  CHECK(std::abs(trial.held[0][0]) < kRounding);        // nothing is known before the first row
  CHECK(std::abs(trial.held[2][0] - 0.5) < kRounding);  // half of row 0, half of row 1
  CHECK(std::abs(trial.held[3][0] - 1.0) < kRounding);
  CHECK(std::abs(trial.told[0][0] - 0.5) < kRounding);  // half of row 0, which tells of the time before it, half of 1
  CHECK(std::abs(trial.told[2][0] - 1.5) < kRounding);
}

TEST_CASE("trial input: rows faster than the grid are averaged, held and told each in their place") {
  const Trial trial = on_grid(rows(0.0, 0.01, 101), 0.1, 10);
  CHECK(trial.input_averaged);
  CHECK(trial.parts() == 1);
  CHECK(trial.input_step == doctest::Approx(0.01));
  for (std::size_t k = 1; k + 1 < trial.t.size(); ++k) {
    CAPTURE(k);
    const double at = 10.0 * static_cast<double>(k);
    // A mean over [t - dt/2, t + dt/2) of rows that lead by half of their own step.
    CHECK(std::abs(trial.input[k][0] - (at - 0.5)) < kRounding);
    CHECK(std::abs(trial.held[k][0] - (at + 4.5)) < kRounding);
    CHECK(std::abs(trial.told[k][0] - (at + 5.5)) < kRounding);
  }
}

TEST_CASE("trial input: a quick vehicle gets the parts of a step, averaged as its velocities were") {
  model::Vehicle quick = with_thrusters(1);
  quick.dof[0] = true;
  quick.parameters = {"m_X", "X_u"};
  quick.priors = {{.mean = 1.0, .sigma = 1.0}, {.mean = -20.0, .sigma = 1.0}};  // settles in 50 ms
  // Two rows to a velocity, on either side of it.
  Recording recording = rows(-0.005, 0.01, 12);
  for (auto& one : recording.thrusters) one.force[0] = std::pow(one.force[0], 2);
  const Trial trial = on_grid(recording, 0.02, 5, {2, 0.01}, quick);
  REQUIRE(trial.parts() == 2);
  REQUIRE(trial.told.size() == trial.held.size());
  const auto row = [](std::size_t k) { return static_cast<double>(k * k); };
  for (std::size_t k = 1; k + 1 < trial.t.size(); ++k) {
    CAPTURE(k);
    for (const std::size_t part : {0, 1}) {
      const std::size_t first = 2 * k + part;  // the row in force from half a row before the part on
      CHECK(std::abs(trial.held[first][0] - 0.5 * (row(first) + row(first + 1))) < kRounding);
      CHECK(std::abs(trial.told[first][0] - 0.5 * (row(first + 1) + row(first + 2))) < kRounding);
    }
  }
}

TEST_CASE("trial input: rows that go back in time or are no numbers have no part in it, and nothing is an error") {
  Recording recording = rows(0.0, 0.1, 5);
  recording.thrusters[2].force = {std::numeric_limits<double>::quiet_NaN()};
  recording.thrusters[3].utime = recording.thrusters[1].utime;
  const Trial trial = on_grid(recording, 0.1, 5);
  CHECK(std::abs(trial.input[1][0] - 1.0) < kRounding);
  CHECK(std::abs(trial.input[3][0] - 3.0) < kRounding);  // between rows 1 and 4
  recording.thrusters.clear();
  Trial none{.name = "rows", .dt = 0.1, .t = {0.0}};
  CHECK_THROWS_AS(add_input(recording, 0, {}, {}, {}, none), InputError);
}

TEST_CASE("trial input: forces of another number of thrusters than the vehicle has are told, or the wrench is taken") {
  Recording recording = rows(0.0, 0.1, 5);
  CHECK_THROWS_WITH_AS(on_grid(recording, 0.1, 5, {}, with_thrusters(4)),
                       doctest::Contains("forces of 1 thrusters, and the vehicle file has 4"), InputError);
  CHECK_THROWS_AS(on_grid(recording, 0.1, 5, {}, with_thrusters(0)), InputError);
  for (Thrusters& one : recording.thrusters) {
    one.has_tau = true;
    one.tau = {3.0, 0.0, 0.0, 0.0, 0.0, 0.0};
  }
  const Trial trial = on_grid(recording, 0.1, 5, {}, with_thrusters(4));
  CHECK(trial.input_is_wrench);
  CHECK(trial.input[1][0] == 3.0);
}

namespace {

/// Whether the input at a time is known.
bool known(const Trial& trial, double t) {
  return trial.input_valid[static_cast<std::size_t>(std::lround(t / trial.dt))] != 0;
}

void lose(Recording& recording, double from, double to) {
  std::erase_if(recording.thrusters, [&](const Thrusters& one) {
    return one.utime > utime_after(0, from) && one.utime < utime_after(0, to);
  });
}

}  // namespace

TEST_CASE("trial input: what was not recorded is not known; a few lost rows are held over") {
  Recording recording = rows(0.0, 0.02, 501);  // 10 s
  lose(recording, 2.005, 3.995);               // from 2 s to 4 s
  lose(recording, 6.005, 6.055);               // two rows
  lose(recording, 7.005, 7.295);               // as long as a command lives
  lose(recording, 8.005, 8.395);
  const Trial trial = on_grid(recording, 0.02, 561);  // 11.2 s
  CHECK(known(trial, 2.0));
  CHECK_FALSE(known(trial, 2.02));
  CHECK_FALSE(known(trial, 3.98));
  CHECK(known(trial, 4.0));
  CHECK(known(trial, 6.04));
  CHECK(known(trial, 7.1));
  CHECK_FALSE(known(trial, 8.2));
  CHECK(known(trial, 10.2));  // the last command lives on
  CHECK_FALSE(known(trial, 10.4));
}

TEST_CASE("trial input: what a quick vehicle would feel of a lost row is not held over") {
  model::Vehicle quick = with_thrusters(1);
  quick.dof[0] = true;
  quick.parameters = {"m_X", "X_u"};
  quick.priors = {{.mean = 1.0, .sigma = 1.0}, {.mean = -20.0, .sigma = 1.0}};  // settles in 50 ms
  Recording recording = rows(0.0, 0.02, 501);
  lose(recording, 6.005, 6.095);
  CHECK(known(on_grid(recording, 0.02, 501), 6.06));
  CHECK_FALSE(known(on_grid(recording, 0.02, 501, {}, quick), 6.06));
}

TEST_CASE("trial input: means draw on nothing that was guessed") {
  Recording recording = rows(0.0, 0.01, 1001);
  lose(recording, 2.005, 3.995);
  const Trial trial = on_grid(recording, 0.1, 100);
  CHECK(trial.input_averaged);
  CHECK(known(trial, 1.9));
  CHECK_FALSE(known(trial, 2.0));
  CHECK_FALSE(known(trial, 4.0));
  CHECK(known(trial, 4.1));
}

TEST_CASE("trial input: commands that are logged when they change are known in between, while anything is recorded") {
  Recording recording;
  recording.name = "changes";
  for (const double t : {0.0, 0.4, 0.9, 3.0, 3.2, 9.0, 9.3, 9.5, 17.0, 18.0})
    recording.thrusters.push_back({.utime = utime_after(0, t), .force = {t}});
  for (int k = 0; k < 400; ++k) recording.dvl.push_back({.utime = utime_after(0, 0.05 * k)});
  const auto all_known = [&] {
    const Trial trial = on_grid(recording, 0.1, 190);
    return std::ranges::all_of(trial.input_valid, [](std::uint8_t one) { return one != 0; });
  };
  CHECK(all_known());
  std::erase_if(recording.dvl,
                [](const Dvl& one) { return one.utime > utime_after(0, 9.5) && one.utime < utime_after(0, 17.0); });
  CHECK_FALSE(all_known());
  CHECK_FALSE(known(on_grid(recording, 0.1, 190), 13.0));
}
