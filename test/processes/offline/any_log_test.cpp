// What fathom smooth and fathom methods make of live logs without a word of configuration: states that are no worse
// than what the log held, or one clear line. Every command on every kind of log: every_command_test.cpp.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <iterator>

#include "common/estimation/online/kalman_estimator.hpp"
#include "common/estimation/smoothing/trial_instruments.hpp"
#include "common/wire/log_reader.hpp"
#include "common/wire/log_writer.hpp"
#include "test/support/full_trial.hpp"
#include "test/support/scratch.hpp"
#include "test/support/shell.hpp"

namespace fathom {
namespace {

using test::file;
using test::program;
using test::Scratch;
using test::shell;

constexpr double kFlown = 60.0;    // s of a live trial: yaw and the beginning of surge
constexpr double kSettled = 10.0;  // s after which states are compared: the live filter is valid by then

/// A live trial as the recorder leaves it: what instruments and estimator said, PROCESS_INFO with its files.
Recording live(const char* site, unsigned seed) {
  Recording recording;
  static_cast<void>(test::run_trial({.seed = seed, .limit = kFlown, .site = site, .recording = &recording}));
  return recording;
}

/// Mean squares of errors against TRUTH: position, velocity; in square metres and in what the state says of itself.
struct Errors {
  double position{}, velocity{}, nees_position{}, nees_velocity{}, count{};
};

template <class State>
Errors errors(const std::vector<State>& states, const std::vector<Truth>& truths) {
  Errors sum;
  std::size_t k = 0;
  for (const Truth& truth : truths) {
    while (k < states.size() && states[k].utime < truth.utime) ++k;
    if (k == states.size() || states[k].utime - truth.utime > 5'000) continue;
    if (seconds_between(truths.front().utime, truth.utime) < kSettled) continue;
    const double dt = seconds_between(truth.utime, states[k].utime);
    const Eigen::Vector3d dp = states[k].p_WB - truth.p_WB - dt * (truth.q_WB * truth.nu.head<3>());
    const Eigen::Vector3d dv = states[k].nu.template head<3>() - truth.nu.head<3>() - dt * truth.nu_dot.head<3>();
    sum.position += dp.squaredNorm();
    sum.velocity += dv.squaredNorm();
    sum.nees_position += dp.cwiseQuotient(states[k].sigma.template head<3>()).squaredNorm() / 3.0;
    sum.nees_velocity += dv.cwiseQuotient(states[k].sigma.template segment<3>(6)).squaredNorm() / 3.0;
    sum.count += 1.0;
  }
  for (double* one : {&sum.position, &sum.velocity, &sum.nees_position, &sum.nees_velocity}) *one /= sum.count;
  return sum;
}

std::string smooth(const Scratch& scratch, const std::string& log) {
  return program("fathom") + " smooth " + scratch.path(log) + " --out " + scratch.path("smooth.lcmlog");
}

bool written(const Scratch& scratch) { return std::filesystem::exists(scratch.path("smooth.lcmlog")); }

}  // namespace

TEST_CASE("fathom smooth: any live log without a word of configuration, and a state no worse than the live one") {
  for (const char* site : {"tank", "deep"}) {
    CAPTURE(site);
    const Scratch scratch;
    const Recording recording = live(site, 21);
    wire::write_log(recording, scratch.path("run.lcmlog"));
    const auto ran = shell(smooth(scratch, "run.lcmlog"));
    REQUIRE_MESSAGE(ran.code == 0, ran.text);
    CHECK_MESSAGE(ran.says("as the log's estimator told"), ran.text);
    CHECK_MESSAGE(!ran.says("not used"), ran.text);
    for (const std::string& instrument : std::string{site} == "tank"
                                             ? std::vector<std::string>{"tag", "optical flow", "laser"}
                                             : std::vector<std::string>{"dvl", "usbl", "range north"})
      CHECK_MESSAGE(ran.says("\n" + instrument), ran.text);
    const Recording result = wire::read_log(scratch.path("smooth.lcmlog")).recording;
    const Errors before = errors(recording.state, recording.truth), after = errors(result.smoothed, recording.truth);
    CHECK(after.position < before.position);
    CHECK(after.velocity < 0.5 * before.velocity);
    // Per component; what lasts (places of tags, a fix's offset) is one draw per run, so that seeds spread.
    CHECK(after.nees_position < 3.0);
    CHECK(after.nees_velocity < 3.0);
  }
}

TEST_CASE("Kalman estimator: a trial in the tank by tags, flow and laser, no worse than the complementary filters") {
  const Recording recording = live("tank", 21);
  const auto told = estimation::instruments_of(recording, estimation::files_in(recording));
  REQUIRE(told.settings.floor);
  CHECK(told.settings.gravity == 9.81);  // the site's
  estimation::KalmanEstimator estimator{told.settings};
  std::vector<StateEstimate> states;
  const auto keep = [&](const estimation::KalmanEstimator::Output& output) {
    std::ranges::copy_if(output, std::back_inserter(states), &StateEstimate::valid);
  };
  // As instruments send them: each stream in its order, what is older first.
  std::size_t tag = 0, flow = 0, laser = 0, depth = 0;
  const auto until = [&](const auto& stream, std::size_t& next, Utime utime) {
    for (; next < stream.size() && stream[next].utime <= utime; ++next) keep(estimator.step(stream[next]));
  };
  for (const Ahrs& one : recording.ahrs) {
    until(recording.tag_pose, tag, one.utime);
    until(recording.optical_flow, flow, one.utime);
    until(recording.laser_range, laser, one.utime);
    until(recording.depth, depth, one.utime);
    keep(estimator.step(one));
  }
  keep(estimator.finish());
  const Errors live_filter = errors(recording.state, recording.truth), kalman = errors(states, recording.truth);
  CHECK(kalman.count > 0.9 * live_filter.count);
  CHECK(kalman.position < live_filter.position);
  CHECK(kalman.velocity < live_filter.velocity);
  auto blind = told.settings;  // without a floor neither flow nor laser is used, and nothing fails
  blind.floor.reset();
  estimation::KalmanEstimator by_tags{blind};
  for (const OpticalFlow& one : recording.optical_flow) static_cast<void>(by_tags.step(one));
  for (const LaserRange& one : recording.laser_range) static_cast<void>(by_tags.step(one));
  CHECK(by_tags.finish().empty());
}

TEST_CASE("fathom smooth: what it lacks is said with the remedy, and nothing is written") {
  const Scratch scratch;
  Recording tank = live("tank", 22);
  const std::vector<ProcessInfo> told = std::exchange(tank.process_info, {});
  wire::write_log(tank, scratch.path("bare.lcmlog"));
  const auto bare = shell(smooth(scratch, "bare.lcmlog"));
  CHECK(bare.code == 1);
  CHECK_MESSAGE(bare.says("nothing that is known tells the position"), bare.text);
  CHECK_MESSAGE(bare.says("no tag's place is known; name the site file (--site)"), bare.text);
  CHECK_FALSE(written(scratch));
  // The pipeline of the live trial is taken as it is, with the vehicle's and the site's files.
  const auto named =
      shell(smooth(scratch, "bare.lcmlog") + " --config " + file("config/pipelines/tank.yaml") + " --vehicle " +
            file("config/vehicles/seabotix_lbv150.yaml") + " --site " + file("config/sites/tank.yaml"));
  CHECK_MESSAGE(named.code == 0, named.text);
  std::filesystem::remove(scratch.path("smooth.lcmlog"));
  // Without the pipeline both files are enough to know where things are.
  const auto places = shell(smooth(scratch, "bare.lcmlog") + " --vehicle " +
                            file("config/vehicles/seabotix_lbv150.yaml") + " --site " + file("config/sites/tank.yaml"));
  CHECK_MESSAGE(places.code == 0, places.text);
  std::filesystem::remove(scratch.path("smooth.lcmlog"));

  // A mistake in a file is one, even where the number is not needed here.
  test::write_bytes(scratch.path("heavy.yaml"),
              "name: Sled\ndof: [surge, sway, heave, roll, pitch, yaw]\nmass: 12 kgs\nwater_density: 1000 kg/m^3\n");
  const auto heavy = shell(smooth(scratch, "bare.lcmlog") + " --vehicle " + scratch.path("heavy.yaml") + " --site " +
                           file("config/sites/tank.yaml"));
  CHECK(heavy.code == 1);
  CHECK_MESSAGE(heavy.says("heavy.yaml:3"), heavy.text);
  CHECK_FALSE(written(scratch));

  tank.process_info = told;
  Recording wrong = tank;  // the laser's dot is another lamp's: tags and flow agree without it
  for (LaserRange& one : wrong.laser_range) one.p_CL *= 0.4;
  wire::write_log(wrong, scratch.path("wrong.lcmlog"));
  const auto contradiction = shell(smooth(scratch, "wrong.lcmlog"));
  CHECK(contradiction.code == 1);
  CHECK_MESSAGE(contradiction.says("contradiction between them"), contradiction.text);
  CHECK_MESSAGE(contradiction.says("laser ("), contradiction.text);
  CHECK_FALSE(written(scratch));

  Recording elsewhere = tank;  // the same tank under another map: all agree with each other and not with STATE
  for (StateEstimate& one : elsewhere.state) one.p_WB.x() += 0.5;
  wire::write_log(elsewhere, scratch.path("elsewhere.lcmlog"));
  const auto against = shell(smooth(scratch, "elsewhere.lcmlog"));
  CHECK(against.code == 1);
  CHECK_MESSAGE(against.says("from the log's own STATE"), against.text);
  CHECK_FALSE(written(scratch));
  const auto despite = shell(smooth(scratch, "elsewhere.lcmlog") + " --despite-state");
  CHECK_MESSAGE(despite.code == 0, despite.text);
}

TEST_CASE("fathom methods: one live log without a word of configuration, on every estimator's states") {
  const Scratch scratch;
  Recording tank = live("tank", 23);
  wire::write_log(tank, scratch.path("tank.lcmlog"));
  const std::string methods =
      program("fathom") + " methods --truth --vehicle " + file("config/vehicles/seabotix_lbv150.yaml") + " --train ";
  const auto ran = shell(methods + scratch.path("tank.lcmlog"));
  REQUIRE_MESSAGE(ran.code == 0, ran.text);
  for (const char* words : {"complementary filter, re", "Kalman filter, recursive", "Kalman smoother, recursi",
                            "smoother, AR(1)", "parameter error, root mean square", "state error, root mean square"})
    CHECK_MESSAGE(ran.says(words), ran.text);
  // Without thrusters nothing can be learnt, and the vehicle file's prior is no result.
  for (Thrusters& one : tank.thrusters) {
    one.force.clear();
    one.has_tau = false;
  }
  wire::write_log(tank, scratch.path("idle.lcmlog"));
  const auto idle = shell(methods + scratch.path("idle.lcmlog"));
  CHECK(idle.code == 1);
  CHECK_MESSAGE(!idle.says("m_X"), idle.text);
}

}  // namespace fathom
