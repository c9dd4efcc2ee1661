// What a recording says against itself: glitches, freezes, repeats and gaps are reported and not used; the rest is
// kept.
#include "common/estimation/run_signals.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "test/support/consistency.hpp"

namespace fathom {

using estimation::read_signals;
using estimation::RunSignals;
using test::find;
using test::SyntheticOptions;

namespace {

constexpr double kDuration = 120.0;  // s

struct Read {
  RunSignals signals;
  std::vector<ConsistencyFinding> findings;
};

Read read(const Recording& recording) {
  Read result;
  result.signals = read_signals(recording, result.findings);
  test::print(result.findings);
  return result;
}

Read read(SyntheticOptions options) {
  options.duration = kDuration;
  return read(test::synthetic_recording(options));
}

bool uses(const std::vector<double>& t, double from, double to) {
  for (const double one : t) {
    if (one > from && one < to) return true;
  }
  return false;
}

}  // namespace

TEST_CASE("run signals: a clean recording is kept whole, in seconds from its first stamp") {
  const Recording recording = test::synthetic_recording({.seed = 1, .duration = kDuration, .accelerometer = true});
  const Read clean = read(recording);
  CHECK(clean.findings.empty());
  CHECK(clean.signals.name == recording.name);
  CHECK(clean.signals.origin == recording.pose_capture.front().utime);
  CHECK(clean.signals.pose.size() == recording.pose_capture.size());
  CHECK(clean.signals.pose.has_position);
  CHECK(clean.signals.pose.has_attitude);
  CHECK(clean.signals.gyro.size() == recording.ahrs.size());
  CHECK(clean.signals.specific_force.size() == recording.ahrs.size());
  CHECK(clean.signals.dvl.size() == recording.dvl.size());
  CHECK(clean.signals.depth.size() == recording.depth.size());
  CHECK(clean.signals.attitude.empty());
  CHECK(clean.signals.gyro.t[1] == doctest::Approx(0.05));
  CHECK(clean.signals.depth.x[0].z() == recording.depth[0].z);
  for (const auto valid : clean.signals.pose.valid) CHECK(valid == 1);
  CHECK(read(Recording{}).signals.pose.empty());
}

TEST_CASE("run signals: slow sensors held in a faster table are taken at their own rate, and nothing looks frozen") {
  Recording recording = test::synthetic_recording(
      {.seed = 1, .duration = kDuration, .pose_rate = 50.0, .gyro_rate = 50.0, .dvl_rate = 50.0});
  const auto hold = [](auto& stream, std::size_t every, const auto& copy) {
    for (std::size_t i = 0; i < stream.size(); ++i) copy(stream[i - i % every], stream[i]);
  };
  hold(recording.pose_capture, 5, [](const PoseCapture& from, PoseCapture& to) {
    to.p_WB = from.p_WB;
    to.q_WB = from.q_WB;
  });
  hold(recording.dvl, 10, [](const Dvl& from, Dvl& to) { to.v_WB_B = from.v_WB_B; });
  const Read read_back = read(recording);
  CHECK(read_back.signals.pose.size() == (recording.pose_capture.size() + 4) / 5);
  CHECK(std::ranges::count(read_back.signals.pose.valid, 0) == 0);
  CHECK(read_back.signals.dvl.size() == (recording.dvl.size() + 9) / 10);
  CHECK(read_back.signals.gyro.size() == recording.ahrs.size());
  REQUIRE(find(read_back.findings, "pose_capture", "held") != nullptr);
  CHECK(find(read_back.findings, "pose_capture", "held")->size == doctest::Approx(0.8).epsilon(0.01));
  CHECK(read_back.findings.size() == 2);
}

TEST_CASE("run signals: leaps of the pose are counted and masked with their neighbours") {
  int count = 0;
  const Read jumpy = read({.seed = 15, .spoil_pose = [&count](PoseCapture& pose) {
                             if (++count % 500 == 0) pose.p_WB.x() += 0.3;
                           }});
  REQUIRE(find(jumpy.findings, "pose_capture", "glitch") != nullptr);
  CHECK(find(jumpy.findings, "pose_capture", "glitch")->size == doctest::Approx(4));
  CHECK(jumpy.findings.size() == 1);
  // The cubic through four neighbours accuses one on each side; three more are masked, since trackers filter.
  for (std::size_t i = 495; i <= 503; ++i) CHECK(jumpy.signals.pose.valid[i] == 0);
  CHECK(jumpy.signals.pose.valid[480] == 1);
}

TEST_CASE("run signals: a quaternion that is not of unit length is reported once and not used") {
  int count = 0;
  const Read bent = read({.seed = 15, .spoil_pose = [&count](PoseCapture& pose) {
                            if (++count == 700) pose.q_WB.coeffs() *= 0.9;
                            if (count == 900) pose.q_WB.coeffs() *= 1.0005;  // rounding
                          }});
  REQUIRE(find(bent.findings, "pose_capture.attitude", "glitch") != nullptr);
  CHECK(find(bent.findings, "pose_capture.attitude", "glitch")->size == 1.0);
  CHECK(bent.signals.pose.valid[699] == 0);
  CHECK(bent.signals.pose.valid[899] == 1);
}

TEST_CASE("run signals: frozen streams are recognised by their leap at the end; rest is not frozen") {
  Eigen::Vector3d last;
  const Read frozen = read({.seed = 16, .spoil_dvl = [&last](Dvl& dvl, double t) {
                              if (t > 50.0 && t < 60.0)
                                dvl.v_WB_B = last;
                              else
                                last = dvl.v_WB_B;
                            }});
  REQUIRE(find(frozen.findings, "dvl", "frozen") != nullptr);
  CHECK(find(frozen.findings, "dvl", "frozen")->size == doctest::Approx(10.0).epsilon(0.03));
  CHECK_FALSE(uses(frozen.signals.dvl.t, 50.5, 59.5));
  PoseCapture held;
  int count = 0;
  const Read pose = read({.seed = 16, .spoil_pose = [&](PoseCapture& sample) {
                            if (++count > 1000 && count < 1060)
                              sample = {sample.utime, held.p_WB, held.q_WB};
                            else
                              held = sample;
                          }});
  REQUIRE(find(pose.findings, "pose_capture", "frozen") != nullptr);
  CHECK(find(pose.findings, "pose_capture", "frozen")->size == doctest::Approx(3.0).epsilon(0.03));
  CHECK(pose.signals.pose.valid[1030] == 0);
  // A simulated vehicle that stands still until it is told to move: repeats, no leap.
  const Read rest = read({.seed = 16, .spoil_dvl = [](Dvl& dvl, double t) {
                            dvl.v_WB_B.setZero();
                            if (t > 60.0) dvl.v_WB_B.x() = 0.3 * (1.0 - std::cos(0.2 * (t - 60.0)));
                          }});
  CHECK(rest.findings.empty());
}

TEST_CASE("run signals: a slow sensor logged at a higher rate is reported as held, and its repeats are not used") {
  Eigen::Vector3d last = Eigen::Vector3d::Zero();
  int count = 0;
  const Read held = read({.seed = 17, .spoil_dvl = [&](Dvl& dvl, double) {
                            if (count++ % 2 == 0)
                              last = dvl.v_WB_B;
                            else
                              dvl.v_WB_B = last;
                          }});
  REQUIRE(find(held.findings, "dvl", "held") != nullptr);
  CHECK(find(held.findings, "dvl", "held")->size == doctest::Approx(0.5).epsilon(0.01));
  CHECK(held.signals.dvl.size() == doctest::Approx(0.5 * count).epsilon(0.01));
}

TEST_CASE("run signals: gaps are measured, short ones pass") {
  const Read lost = read({.seed = 17, .spoil_dvl = [](Dvl& dvl, double t) {
                            dvl.valid = (t < 50.0 || t > 53.0) && (t < 80.0 || t > 80.25);
                          }});
  REQUIRE(find(lost.findings, "dvl", "gap") != nullptr);
  CHECK(find(lost.findings, "dvl", "gap")->size == doctest::Approx(3.0).epsilon(0.05));
  CHECK(lost.findings.size() == 1);
  CHECK(find(lost.findings, "dvl", "gap")->evidence.find("1 gaps") == 0);
}

TEST_CASE("run signals: what is not finite, not fresh or out of order never enters") {
  Recording recording = test::synthetic_recording({.seed = 18, .duration = kDuration});
  recording.ahrs[100].w_WB_B.y() = std::numeric_limits<double>::quiet_NaN();
  recording.ahrs[200].utime = recording.ahrs[150].utime;
  recording.dvl[300].held = true;
  recording.dvl[400].valid = false;
  recording.pose_capture[500].p_WB.z() = std::numeric_limits<double>::infinity();
  recording.pose_capture[600].utime = recording.pose_capture[599].utime;
  const Read odd = read(recording);
  CHECK(odd.signals.gyro.size() == recording.ahrs.size() - 2);
  CHECK(odd.signals.dvl.size() == recording.dvl.size() - 2);
  CHECK(odd.signals.pose.size() == recording.pose_capture.size() - 2);
  for (std::size_t i = 1; i < odd.signals.gyro.size(); ++i) CHECK(odd.signals.gyro.t[i] > odd.signals.gyro.t[i - 1]);
  for (const Eigen::Vector3d& x : odd.signals.gyro.x) CHECK(x.allFinite());
}

TEST_CASE("run signals: an AHRS without motion capture gives the attitude") {
  Recording recording = test::synthetic_recording({.seed = 19, .duration = kDuration, .pose_rate = 0.0});
  const test::SyntheticMotion motion(19);
  for (std::size_t i = 0; i < recording.ahrs.size(); ++i) {
    Ahrs& sample = recording.ahrs[i];
    sample.q_WB = Eigen::Quaterniond(motion.R_WB(0.05 * static_cast<double>(i)));
    if (i % 3 == 0) sample.q_WB.coeffs() *= -1.0;  // the same attitude
    sample.has_attitude = true;
  }
  recording.ahrs[50].q_WB.coeffs() *= 0.5;
  const Read ahrs = read(recording);
  CHECK(ahrs.signals.attitude.has_attitude);
  CHECK_FALSE(ahrs.signals.attitude.has_position);
  CHECK(ahrs.signals.attitude.size() == recording.ahrs.size() - 1);
  for (std::size_t i = 1; i < ahrs.signals.attitude.size(); ++i) {
    CHECK(ahrs.signals.attitude.q_WB[i].dot(ahrs.signals.attitude.q_WB[i - 1]) > 0.0);
  }
}

TEST_CASE("run signals: a fast vehicle on uneven stamps does not leap, and a leap is seen among them") {
  SyntheticOptions options{.seed = 12, .pose_rate = 50.0, .position_noise = 0.001, .activity = {10, 10, 1, 1, 1, 4}};
  options.uneven = 0.5;
  options.missing = 0.05;
  options.duration = kDuration;
  Recording recording = test::synthetic_recording(options);
  CHECK(find(read(recording).findings, "pose_capture", "glitch") == nullptr);
  recording.pose_capture[3000].p_WB.x() += 0.3;
  const auto found = read(recording).findings;
  const ConsistencyFinding* leap = find(found, "pose_capture", "glitch");
  REQUIRE(leap != nullptr);
  CHECK(leap->size == 1.0);
}

}  // namespace fathom
