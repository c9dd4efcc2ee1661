// Sensors compared with STATE while a trial runs: faults are named with their numbers, clean sensors are not accused,
// and neither the order of arrival nor the machine's speed changes what is said when.
#include "common/diagnosis/live_sensor_check.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "test/support/synthetic_recording.hpp"
#include "test/support/timing.hpp"

using namespace fathom;
using diagnosis::LiveSensorCheck;

namespace {

StateEstimate state_of(const PoseCapture& pose) {
  return {.utime = pose.utime, .p_WB = pose.p_WB, .q_WB = pose.q_WB, .valid = pose.valid};
}

/// When the answer changed, and to how many faults.
using Answers = std::vector<std::pair<Utime, std::size_t>>;

/// Sensors come `late` after the states of their time.
Answers listen(LiveSensorCheck& check, const Recording& recording, double late = 0.0) {
  Answers answers;
  auto ahrs = recording.ahrs.begin();
  auto dvl = recording.dvl.begin();
  for (const PoseCapture& pose : recording.pose_capture) {
    const Utime now = utime_after(pose.utime, -late);
    for (; ahrs != recording.ahrs.end() && ahrs->utime <= now; ++ahrs) check.hear(*ahrs);
    for (; dvl != recording.dvl.end() && dvl->utime <= now; ++dvl) check.hear(*dvl);
    check.step(state_of(pose));
    if (answers.empty() || answers.back().second != check.faults().size())
      answers.emplace_back(pose.utime, check.faults().size());
  }
  return answers;
}

double seconds(const Recording& recording, Utime utime) {
  return seconds_between(recording.pose_capture.front().utime, utime);
}

}  // namespace

TEST_CASE("live sensor check: a gyro that is late is named while the trial runs, with its delay") {
  const Recording recording = test::synthetic_recording({.seed = 3, .dvl_rate = 0.0, .gyro_delay = 0.12}, "trial");
  LiveSensorCheck check;
  const Answers answers = listen(check, recording);
  REQUIRE(answers.size() == 2);
  CHECK(answers.front().second == 0);
  CHECK(seconds(recording, answers.back().first) == doctest::Approx(80.0).epsilon(0.01));  // asked at 60 s
  for (int round = 0; round < 2; ++round, check.finish()) {
    REQUIRE(check.faults().size() == 1);
    const EffectEvidence& fault = check.faults().front();
    CHECK(fault.name == "sensor_latency");
    CHECK(fault.variant == "gyro");
    CHECK(fault.log_odds > 5.0);
    REQUIRE(fault.numbers.size() == 1);
    CHECK(fault.numbers.front() == doctest::Approx(0.12).epsilon(0.1));
  }
}

TEST_CASE("live sensor check: a gyro's scale and a velocity log's lever arm") {
  test::SyntheticOptions options{.seed = 4, .dvl_lever = {0.3, 0.0, 0.0}};
  options.gyro_matrix = 1.1 * Eigen::Matrix3d::Identity();
  LiveSensorCheck check;
  (void)listen(check, test::synthetic_recording(options, "trial"));
  check.finish();
  const auto named = [&](const char* name) {
    return std::ranges::find(check.faults(), std::string{name}, &EffectEvidence::name);
  };
  REQUIRE(named("sensor_scale") != check.faults().end());
  REQUIRE(named("lever_arm") != check.faults().end());
  for (const double error : named("sensor_scale")->numbers) CHECK(error == doctest::Approx(0.1).epsilon(0.1));
}

TEST_CASE("live sensor check: what is in order is not accused, at any look") {
  for (unsigned seed = 1; seed <= test::seeds(10); ++seed) {
    CAPTURE(seed);
    LiveSensorCheck check;
    test::SyntheticOptions options{.seed = seed, .duration = 130.0, .dvl_rate = seed % 2 == 0 ? 8.0 : 0.0};
    options.accelerometer = true;
    const Answers answers = listen(check, test::synthetic_recording(options, "trial"));
    CHECK(answers.size() == 1);
    check.finish();
    CHECK(check.faults().empty());
  }
}

TEST_CASE("live sensor check: velocities that only STATE tells are no witness, and STATE itself is no sensor") {
  // The clock of the poses is late: whoever is compared with them seems early.
  Recording recording = test::synthetic_recording({.seed = 6, .gyro_delay = -0.15}, "trial");
  recording.dvl.clear();
  LiveSensorCheck check;
  (void)listen(check, recording);
  check.finish();
  CHECK(check.faults().empty());
}

TEST_CASE("live sensor check: neither the order of arrival nor a reset changes what is said, nor when") {
  const Recording recording = test::synthetic_recording({.seed = 3, .duration = 150.0, .gyro_delay = 0.12}, "trial");
  LiveSensorCheck check;
  const Answers expected = listen(check, recording);
  const std::vector<EffectEvidence> faults = check.faults();
  for (const double late : {0.3, 0.9}) {
    check.reset();
    CHECK(check.faults().empty());
    CHECK(listen(check, recording, late) == expected);
    REQUIRE(check.faults().size() == faults.size());
    for (std::size_t i = 0; i < faults.size(); ++i) {
      CHECK(check.faults()[i].log_odds == faults[i].log_odds);
      CHECK(check.faults()[i].numbers == faults[i].numbers);
    }
  }
}
