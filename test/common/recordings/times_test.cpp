// Which times are believed, and when a value was true.
#include <doctest/doctest.h>

#include <cmath>
#include <random>

#include "common/base/error.hpp"
#include "common/recordings/clocks.hpp"
#include "common/recordings/merge.hpp"
#include "common/recordings/stamp_guard.hpp"

namespace fathom {
namespace {

using recordings::kNoTime;
using recordings::Stamp;
constexpr std::int64_t kSecond = 1'000'000;
constexpr recordings::ClockRules kSinceBoot{.back = kSecond};
constexpr recordings::ClockRules kOfDay{};

struct Judgement {
  std::vector<std::int64_t> believed, refused;
  std::vector<std::size_t> recording;
};

Judgement judged(const std::vector<std::int64_t>& stamps, recordings::ClockRules rules) {
  Judgement out;
  recordings::StampGuard guard{rules,
                               [&](const recordings::Judged& one, std::size_t recording) {
                                 out.believed.push_back(one.stamp.log);
                                 out.recording.push_back(recording);
                               },
                               [&](const recordings::Judged& one) { out.refused.push_back(one.stamp.log); }};
  for (const std::int64_t stamp : stamps) guard.push(0, {.log = stamp}, {});
  guard.finish();
  return out;
}

std::vector<std::int64_t> steady(std::int64_t begin, std::int64_t step, int count) {
  std::vector<std::int64_t> stamps;
  for (int i = 0; i < count; ++i) stamps.push_back(begin + i * step);
  return stamps;
}

}  // namespace

TEST_CASE("stamps: one that leaps, ahead or back, at the beginning, within or at the end, is refused alone") {
  for (const std::size_t at : {std::size_t{0}, std::size_t{50}, std::size_t{100}}) {
    for (const std::int64_t wrong :
         {std::int64_t{1140} * kSecond, std::int64_t{1}, std::int64_t{7'377'569'733'434'081'793}}) {
      CAPTURE(at);
      CAPTURE(wrong);
      std::vector<std::int64_t> stamps = steady(100 * kSecond, 20'000, 100);
      stamps.insert(stamps.begin() + static_cast<std::ptrdiff_t>(at), wrong);
      const Judgement out = judged(stamps, kSinceBoot);
      CHECK(out.refused == std::vector<std::int64_t>{wrong});
      CHECK(out.believed.size() == 100);
      CHECK(out.recording.back() == 0);
    }
  }
}

TEST_CASE("stamps: a gap is a gap, a slow recording is whole, writers may be a little late") {
  std::vector<std::int64_t> stamps = steady(0, 20'000, 100);
  const auto later = steady(600 * kSecond, 20'000, 100);
  stamps.insert(stamps.end(), later.begin(), later.end());
  CHECK(judged(stamps, kSinceBoot).refused.empty());
  CHECK(judged(stamps, kSinceBoot).recording.back() == 0);
  CHECK(judged(steady(0, 60 * kSecond, 30), kOfDay).refused.empty());
  CHECK(judged(steady(0, 60 * kSecond, 3), kOfDay).refused.empty());
  std::vector<std::int64_t> swapped = steady(0, 20'000, 100);
  for (std::size_t i = 0; i + 1 < swapped.size(); i += 2) std::swap(swapped[i], swapped[i + 1]);
  CHECK(judged(swapped, kSinceBoot).refused.empty());
  CHECK(judged(swapped, kSinceBoot).recording.back() == 0);
}

TEST_CASE("stamps: a clock that starts anew begins another recording; a block that was only written late does not") {
  std::vector<std::int64_t> stamps = steady(265 * kSecond, 20'000, 200);
  const auto second = steady(3 * kSecond, 20'000, 200);
  stamps.insert(stamps.end(), second.begin(), second.end());
  const Judgement boots = judged(stamps, kSinceBoot);
  CHECK(boots.refused.empty());
  CHECK(boots.recording.front() == 0);
  CHECK(boots.recording.back() == 1);
  const Judgement blocks = judged(stamps, kOfDay);
  CHECK(blocks.refused.empty());
  CHECK(blocks.recording.back() == 0);
}

TEST_CASE("clocks: header stamps of the same clock are taken as they are, whatever the delay of receipt") {
  std::vector<recordings::TopicStamps> both(2);
  recordings::TopicStamps &imu = both[0], &dvl = both[1];
  imu.topic = "/imu", dvl.topic = "/dvl";
  for (int i = 0; i < 100; ++i) {
    imu.stamps.push_back({1'600'000'000 * kSecond + i * 20'000 + 3000, 1'600'000'000 * kSecond + i * 20'000});
    std::int64_t measured = 1'600'000'000 * kSecond + i * 100'000;
    const std::int64_t log = measured + 60'000 + (i % 9) * 10'000;
    if (i == 50) measured = 5;  // nonsense: receipt, less the delay of the one before
    if (i == 51) measured = kNoTime;
    dvl.stamps.push_back({log, measured});
  }
  const auto out = recordings::align_clocks(both);
  for (std::size_t i = 0; i < 100; ++i) CHECK(out.times[0][i] == imu.stamps[i].measured);
  CHECK(out.times[1][10] == dvl.stamps[10].measured);
  CHECK(std::abs(out.times[1][50] - (1'600'000'000 * kSecond + 50 * 100'000)) < 100'000);
  CHECK(out.notes.size() == 3);
}

TEST_CASE(
    "clocks: topics of a vehicle's own clock keep their intervals, are set by the earliest arrival, and follow its "
    "drift") {
  constexpr double kDrift = 50e-6;
  std::mt19937 random{3};
  std::exponential_distribution<double> late{1.0 / 0.03};
  std::vector<recordings::TopicStamps> both(2);
  recordings::TopicStamps &fast = both[0], &slow = both[1];
  fast.topic = "ATTITUDE", slow.topic = "RAW_IMU";
  const auto received = [&](double boot) {
    return static_cast<std::int64_t>(1e6 * (1.6e9 + boot * (1.0 + kDrift) + late(random)));
  };
  for (int i = 0; i < 30'000; ++i) {
    const double boot = 200.0 + 0.05 * i;
    fast.stamps.push_back({received(boot), static_cast<std::int64_t>(1e6 * boot)});
    if (i % 2 == 0) slow.stamps.push_back({received(boot + 0.01), static_cast<std::int64_t>(1e6 * (boot + 0.01))});
  }
  const auto out = recordings::align_clocks(both);
  for (const std::size_t i : {std::size_t{0}, std::size_t{15'000}, std::size_t{29'999}}) {
    const double boot = 1e-6 * static_cast<double>(fast.stamps[i].measured);
    CHECK(1e-6 * static_cast<double>(out.times[0][i]) ==
          doctest::Approx(1.6e9 + boot * (1.0 + kDrift)).epsilon(2e-3 / 1.6e9));
  }
  CHECK(std::abs(out.times[1][0] - out.times[0][0] - 10'000) <= 2);  // the drift of 10 ms, rounded twice
  CHECK(out.notes.size() == 1);
}

TEST_CASE("merging: the shift between two clocks is found by the motion that both measured, or stated, or asked for") {
  std::mt19937 random{5};
  std::normal_distribution<double> normal;
  Recording pilot, mocap;
  pilot.name = "pilot";
  mocap.name = "mocap";
  double rate = 0.0, angle = 0.0;
  std::vector<double> rates;
  for (int i = 0; i < 6000; ++i) {
    rate += 0.02 * (-0.5 * rate + normal(random));
    rates.push_back(rate);
  }
  for (int i = 0; i < 6000; ++i) {
    const double t = 0.02 * i;
    angle += 0.02 * rates[static_cast<std::size_t>(i)];
    pilot.ahrs.push_back({.utime = utime_after(0, 100.0 + t),
                          .w_WB_B = {0, 0, rates[static_cast<std::size_t>(i)] + 0.01 * normal(random)},
                          .has_rates = true});
    pilot.thrusters.push_back({.utime = utime_after(0, 100.0 + t)});
    if (i >= 1000 && i < 5000)
      mocap.pose_capture.push_back({.utime = utime_after(0, 5.0 + t - 20.0),
                                    .q_WB = Eigen::Quaterniond(Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitZ()))});
  }
  std::vector<std::string> notes;
  const Recording merged = recordings::merge({pilot, mocap}, {std::nullopt, std::nullopt}, notes);
  REQUIRE(merged.pose_capture.size() == 4000);
  // Sample i = 1000 was at 120 s on the pilot's clock; a differentiated pose is worth some milliseconds.
  CHECK(seconds_between(0, merged.pose_capture.front().utime) == doctest::Approx(120.0).epsilon(0.02 / 120.0));
  CHECK(notes.size() == 1);
  CHECK(notes[0].find("turn rate") != std::string::npos);

  const Recording stated = recordings::merge({pilot, mocap}, {std::nullopt, 115.0}, notes);
  CHECK(seconds_between(0, stated.pose_capture.front().utime) == doctest::Approx(120.0));

  Recording still = mocap;
  for (PoseCapture& pose : still.pose_capture) pose.q_WB = Eigen::Quaterniond::Identity();
  CHECK_THROWS_AS((void)recordings::merge({pilot, still}, {std::nullopt, std::nullopt}, notes), InputError);

  Recording both = mocap;
  both.ahrs = pilot.ahrs;
  notes.clear();
  CHECK(recordings::merge({pilot, both}, {std::nullopt, 0.0}, notes).ahrs.size() == pilot.ahrs.size());
  CHECK(notes.back().find("ahrs left out") != std::string::npos);
}

TEST_CASE("merging: columns that are carried come together by their names") {
  Recording pilot, shore;
  pilot.name = "pilot", shore.name = "shore";
  pilot.signals = {{1'000'000, "wind", "", "m/s", 5.0}, {3'000'000, "wind", "", "m/s", 6.0}};
  shore.signals = {
      {1'000'000, "tide", "", "m", 1.0}, {2'000'000, "wind", "", "m/s", 9.0}, {4'000'000, "tide", "", "m", 2.0}};
  std::vector<std::string> notes;
  const Recording run = recordings::merge({pilot, shore}, {std::nullopt, 0.5}, notes);
  REQUIRE(run.signals.size() == 4);
  CHECK(std::ranges::is_sorted(run.signals, {}, &Signal::utime));
  CHECK(run.signals[1].name == "tide");
  CHECK(run.signals[1].utime == 1'500'000);
  REQUIRE(notes.size() == 1);
  CHECK(notes[0].find("column 'wind' left out: pilot has them") != std::string::npos);
}

}  // namespace fathom
