// Sensors compared with STATE while a trial runs: faults are named with their numbers, clean sensors are not accused,
// and neither the order of arrival nor the machine's speed changes what is said when.
#include "common/diagnosis/live_sensor_check.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "test/support/synthetic_pictures.hpp"
#include "test/support/timing.hpp"

using namespace fathom;
using diagnosis::LiveSensorCheck;

namespace {

StateEstimate state_of(const PoseCapture& pose) {
  return {.utime = pose.utime, .p_WB = pose.p_WB, .q_WB = pose.q_WB, .valid = pose.valid};
}

/// When the answer changed, and to how many faults.
using Answers = std::vector<std::pair<Utime, std::size_t>>;

/// Sensors come `late` after the states of their time; `told`: when each came, where stamps lie.
Answers listen(LiveSensorCheck& check, const Recording& recording, double late = 0.0, const Recording* told = nullptr) {
  const Recording& came = told != nullptr ? *told : recording;
  Answers answers;
  std::size_t ahrs = 0, dvl = 0;
  for (std::size_t k = 0; k < recording.pose_capture.size(); ++k) {
    const Utime now = utime_after(came.pose_capture[k].utime, -late);
    for (; ahrs < came.ahrs.size() && came.ahrs[ahrs].utime <= now; ++ahrs) check.hear(recording.ahrs[ahrs]);
    for (; dvl < came.dvl.size() && came.dvl[dvl].utime <= now; ++dvl) check.hear(recording.dvl[dvl]);
    check.step(state_of(recording.pose_capture[k]));
    if (answers.empty() || answers.back().second != check.faults().size())
      answers.emplace_back(recording.pose_capture[k].utime, check.faults().size());
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
  REQUIRE(named("lever_arm") != check.faults().end());
  CHECK(named("lever_arm")->variant == "dvl");
  REQUIRE(named("lever_arm")->numbers.size() == 3);
  CHECK(std::abs(named("lever_arm")->numbers[0]) == doctest::Approx(0.3).epsilon(0.1));
  CHECK(std::abs(named("lever_arm")->numbers[1]) < 0.05);
  for (const char* axis : {"gyro.p", "gyro.q", "gyro.r"}) {
    const auto scale = std::ranges::find_if(
        check.faults(), [&](const EffectEvidence& e) { return e.name == "sensor_scale" && e.variant == axis; });
    REQUIRE(scale != check.faults().end());
    REQUIRE(scale->numbers.size() == 1);
    CHECK(scale->numbers.front() == doctest::Approx(0.1).epsilon(0.1));
  }
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

TEST_CASE("live sensor check: STATE is no sensor, also beside one that is late") {
  // The clock of the poses is late: whoever is compared with them seems early.
  for (const double dvl_rate : {0.0, 10.0}) {
    const Recording recording =
        test::synthetic_recording({.seed = 6, .dvl_rate = dvl_rate, .gyro_delay = -0.15, .dvl_delay = 0.1}, "trial");
    LiveSensorCheck check;
    (void)listen(check, recording);
    check.finish();
    CHECK(check.faults().empty() == (dvl_rate == 0.0));
    for (const EffectEvidence& fault : check.faults()) CHECK(fault.variant == "dvl");
  }
}

TEST_CASE("live sensor check: what STATE is corrected for is no finding") {
  const Recording recording = test::synthetic_recording({.seed = 3, .gyro_delay = 0.12}, "trial");
  estimation::Corrections corrections;
  corrections.gyro_shift = -0.12;
  LiveSensorCheck check{corrections};
  for (int round = 0; round < 2; ++round) {
    (void)listen(check, recording);
    check.finish();
    CHECK(check.faults().empty());
    check.reset();
  }
}

TEST_CASE("live sensor check: rest takes nothing back") {
  Recording recording = test::synthetic_recording({.seed = 3, .dvl_rate = 0.0, .gyro_delay = 0.12}, "trial");
  const PoseCapture still = recording.pose_capture.back();
  for (int k = 1; k <= 12'000; ++k) {
    recording.pose_capture.push_back(still);
    recording.pose_capture.back().utime = utime_after(still.utime, 0.05 * k);
    recording.ahrs.push_back({.utime = recording.pose_capture.back().utime, .has_rates = true});
  }
  LiveSensorCheck check;
  CHECK(listen(check, recording).back().second == 1);
  check.finish();
  REQUIRE(check.faults().size() == 1);
  CHECK(check.faults().front().name == "sensor_latency");
}

TEST_CASE("live sensor check: clocks that leap cost a moment, not the check") {
  const test::SyntheticOptions options{.seed = 3, .dvl_rate = 0.0, .gyro_delay = 0.12};
  const Recording recording = test::synthetic_recording(options, "trial");
  const auto one_late_gyro = [&](const Recording& run) {
    LiveSensorCheck check;
    CHECK(listen(check, run, 0.0, &recording).back().second == 1);
  };
  const auto leap = [&](double at, std::size_t samples, double seconds) {
    Recording run = recording;
    const auto from = static_cast<std::ptrdiff_t>(at * options.gyro_rate);
    for (auto k = run.ahrs.begin() + from; k != run.ahrs.begin() + from + static_cast<std::ptrdiff_t>(samples); ++k)
      k->utime = utime_after(k->utime, seconds);
    return run;
  };
  one_late_gyro(leap(30.0, 1, 86'400.0));
  one_late_gyro(leap(0.0, 1, 86'400.0));
  one_late_gyro(leap(20.0, 1, -3'600.0));
  SUBCASE("all of them, as when a clock is set") {
    Recording run = recording;
    const auto set = [](auto& stream, Utime from) {
      for (auto& one : stream) {
        if (one.utime >= from) one.utime = utime_after(one.utime, 3'600.0);
      }
    };
    const Utime moment = utime_after(run.pose_capture.front().utime, 30.0);
    set(run.pose_capture, moment);
    set(run.ahrs, moment);
    one_late_gyro(run);
  }
}

TEST_CASE("live sensor check: a wild stamp costs no more than it leapt") {
  const test::SyntheticOptions options{.seed = 3, .duration = 58.0, .dvl_rate = 0.0, .gyro_delay = 0.12};
  const Recording recording = test::synthetic_recording(options, "trial");
  for (const double seconds : {-3'600.0, -5.0, 5.0, 3'600.0}) {
    CAPTURE(seconds);
    Recording run = recording;
    Ahrs& wild = run.ahrs[static_cast<std::size_t>(50.0 * options.gyro_rate)];
    wild.utime = utime_after(wild.utime, seconds);
    LiveSensorCheck check;
    (void)listen(check, run, 0.0, &recording);
    check.finish();
    REQUIRE(check.faults().size() == 1);
    CHECK(check.faults().front().numbers.front() == doctest::Approx(0.12).epsilon(0.1));
  }
}

TEST_CASE("live sensor check: neither the order of arrival nor a reset changes what is said, nor when") {
  for (const double duration : {150.0, 700.0}) {
    const Recording recording =
        test::synthetic_recording({.seed = 3, .duration = duration, .gyro_delay = 0.12}, "trial");
    LiveSensorCheck check;
    const Answers expected = listen(check, recording);
    const std::vector<EffectEvidence> faults = check.faults();
    REQUIRE_FALSE(faults.empty());
    for (const double late : {0.3, 0.9, -0.9, -20.0}) {
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
}

TEST_CASE("live sensor check: a flow that reads too small is named while the trial runs; one that is right is not") {
  for (const double factor : {1.0, 0.87}) {
    CAPTURE(factor);
    const test::Pictures pictures{{.seed = 4, .flow_factor = {1.0, factor}}};
    LiveSensorCheck check{{}, consistency::FlowWitnesses{pictures.mounts, pictures.site}};
    const Recording& recording = pictures.recording;
    const std::size_t tags = recording.tag_pose.size() / recording.state.size();
    for (int round = 0; round < 2; ++round) {  // the second after a reset
      double named = 0.0;
      for (std::size_t k = 0; k < recording.state.size(); ++k) {
        for (std::size_t i = 0; i < tags; ++i) check.hear(recording.tag_pose[k * tags + i]);
        check.hear(recording.optical_flow[k]);
        const StateEstimate& state = recording.state[k];
        check.hear(Ahrs{.utime = state.utime, .w_WB_B = state.nu.tail<3>(), .has_rates = true});
        check.step(state);
        if (named == 0.0 && !check.faults().empty()) {
          named = seconds_between(recording.state.front().utime, state.utime);
        }
      }
      check.finish();
      if (factor == 1.0) {
        CHECK(check.faults().empty());
      } else {
        CHECK(named == doctest::Approx(80.0).epsilon(0.01));  // asked at 60 s
        REQUIRE(check.faults().size() == 1);
        CHECK(check.faults().front().name == "sensor_scale");
        CHECK(check.faults().front().variant == "optical_flow.v");
        CHECK(check.faults().front().numbers.front() == doctest::Approx(factor - 1.0).epsilon(0.1));
      }
      check.reset();
    }
  }
}

TEST_CASE("live sensor check: a flow in which turning was left is named with its arm, and has been judged either way") {
  for (const double arm : {0.0, -0.2}) {
    CAPTURE(arm);
    const test::Pictures pictures{{.seed = 4, .flow_arm = {arm, 0.0, 0.0}}};
    LiveSensorCheck check{{}, consistency::FlowWitnesses{pictures.mounts, pictures.site}};
    const std::size_t tags = pictures.recording.tag_pose.size() / pictures.recording.state.size();
    for (std::size_t k = 0; k < pictures.recording.state.size(); ++k) {
      for (std::size_t i = 0; i < tags; ++i) check.hear(pictures.recording.tag_pose[k * tags + i]);
      check.hear(pictures.recording.optical_flow[k]);
      check.step(pictures.recording.state[k]);
    }
    CHECK(check.velocity_judged());
    REQUIRE(check.faults().size() == (arm == 0.0 ? 0 : 1));
    if (arm == 0.0) continue;
    CHECK(check.faults().front().name == "lever_arm");
    CHECK(check.faults().front().variant == "optical_flow");
    CHECK(check.faults().front().numbers.front() == doctest::Approx(arm).epsilon(0.15));
    check.reset();
    CHECK_FALSE(check.velocity_judged());
  }
}

TEST_CASE("live sensor check: how far a gyro is turned, and that one in place is not") {
  for (const double turn : {0.0, 0.03}) {
    test::SyntheticOptions options{.seed = 8, .duration = 130.0};
    const Eigen::Matrix3d R = rotation_from_euler({0.0, turn, 0.0});
    options.gyro_matrix = R;
    LiveSensorCheck check;
    (void)listen(check, test::synthetic_recording(options, "trial"));
    check.finish();
    CHECK(check.faults().empty());
    CHECK(check.turns().gyro.isApprox(R.transpose(), turn == 0.0 ? 0.0 : 5e-3));
    CHECK(check.turns().dvl == Eigen::Matrix3d::Identity());
    check.reset();
    CHECK(check.turns() == LiveSensorCheck::Turns{});
  }
}
