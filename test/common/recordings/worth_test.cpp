// What stands against fitting anything to a recording is said, and nothing is said of one that can be used.
#include "common/recordings/worth.hpp"

#include <doctest/doctest.h>

#include <cmath>

namespace fathom::recordings {
namespace {

constexpr double kRate = 10.0;  // Hz of everything

struct Dive {
  double command_rate{kRate};  // Hz
  double pulse{200.0};         // us either way of neutral
  double speed{0.0};           // m/s, ahead
  double turning{0.0};         // rad/s, amplitude
};

Recording dive(const Dive& of) {
  Recording recording;
  for (int i = 0; i < 300; ++i) {
    const double t = i / kRate;
    const Utime utime = utime_after(0, t);
    Ahrs ahrs{.utime = utime, .has_rates = true};
    ahrs.w_WB_B.z() = of.turning * std::sin(t);
    recording.ahrs.push_back(ahrs);
    recording.dvl.push_back({.utime = utime, .v_WB_B = {of.speed, 0.0, 0.0}, .valid = true});
  }
  for (double t = 0.0; t < 30.0; t += 1.0 / of.command_rate) {
    Thrusters thrusters;
    thrusters.utime = utime_after(0, t);
    thrusters.pwm_us = {1500.0, 1500.0 + of.pulse * std::sin(t)};
    recording.thrusters.push_back(thrusters);
  }
  return recording;
}

bool says(const Recording& recording, const std::string& words) {
  for (const std::string& reason : against_fitting(recording)) {
    if (reason.find(words) != std::string::npos) return true;
  }
  return false;
}

}  // namespace

TEST_CASE("worth: a craft that turns, and one that only goes steadily ahead, can be used") {
  CHECK(against_fitting(dive({.speed = 0.5, .turning = 0.2})).empty());
  CHECK(against_fitting(dive({.speed = 0.5})).empty());
  CHECK(against_fitting(dive({.turning = 0.2})).empty());
}

TEST_CASE("worth: rare commands, none, pulses within the dead band and a craft at rest are each said") {
  CHECK(says(dive({.command_rate = 2.0, .turning = 0.2}), "thruster commands come at 2.0 Hz"));
  CHECK(says(dive({.pulse = 5.0, .turning = 0.2}), "pulses stay within 10 us"));
  const Recording still = dive({});
  CHECK(says(still, "the craft never moves: rates scatter by 0.0000 rad/s, velocity is 0.000 m/s (RMS)"));
  Recording adrift = dive({.turning = 0.2});
  adrift.thrusters.clear();
  CHECK(says(adrift, "nothing says what the thrusters did"));
  adrift.dvl.clear();
  CHECK(says(adrift, "neither velocity nor position was measured"));
  adrift.usbl.emplace_back();
  CHECK_FALSE(says(adrift, "neither velocity nor position was measured"));
}

TEST_CASE("worth: shaft speeds and rudder angles are no pulses, and are told only where they never change") {
  Recording run = dive({.speed = 0.5, .turning = 0.2});
  for (std::size_t i = 0; i < run.thrusters.size(); ++i)
    run.thrusters[i].pwm_us = {94.2, 0.1 * std::sin(0.1 * static_cast<double>(i))};  // rad/s, rad
  CHECK(against_fitting(run).empty());
  for (Thrusters& one : run.thrusters) one.pwm_us = {94.2, 0.05};
  CHECK(says(run, "commands never change: nothing was commanded"));
}

}  // namespace fathom::recordings
