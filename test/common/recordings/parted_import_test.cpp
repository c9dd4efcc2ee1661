// Recordings with topics on their way to samples, part after part; and what a map may call a topic.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "common/base/error.hpp"
#include "common/recordings/import.hpp"
#include "test/support/foreign_logs.hpp"
#include "test/support/scratch.hpp"

namespace fathom {
namespace {

using test::packed;

const std::string kAbout = "source: s\nlicence: l\n";

/// Gyros at 100 Hz (as many as `instances`, numbered where that is not 0), attitude at 25 Hz, pulses at 10 Hz for ten
/// seconds, some attitudes late by two; one pulse stands there twice.
std::string log_of(int instances) {
  test::DataFlashLog log;
  const bool numbered = instances > 0;
  log.format(1, numbered ? 24 : 23, "IMU", numbered ? "QBfff" : "Qfff",
             numbered ? "TimeUS,I,GyrX,GyrY,GyrZ" : "TimeUS,GyrX,GyrY,GyrZ");
  log.format(2, 23, "ATT", "Qfff", "TimeUS,Roll,Pitch,Yaw");
  log.format(3, 15, "RCOU", "QHH", "TimeUS,C1,C2");
  for (unsigned k = 0; k < 1000; ++k) {
    const std::uint64_t time = 1'000'000 + 10'000U * k;
    for (int i = std::max(instances, 1) - 1; i >= 0; --i) {  // the last instance comes first
      const std::string rates = packed(0.01F * static_cast<float>(k), 1.0F, static_cast<float>(i));
      log.record(1, numbered ? packed(time, static_cast<std::uint8_t>(i)) + rates : packed(time) + rates);
    }
    if (k % 4 == 0) {
      const std::uint64_t then = k % 40 == 0 && k > 0 ? time - 50'000 : time;
      log.record(2, packed(then, 10.0F, 0.0F, static_cast<float>(k)));
    }
    const auto pulse = packed(time, static_cast<std::uint16_t>(1500 + k % 300), std::uint16_t{1500});
    if (k % 10 == 0) log.record(3, pulse);
    if (k == 500) log.record(3, pulse);
  }
  return log.bytes;
}

const std::string kMap = kAbout +
                         "ahrs:\n  - rates: {columns: [IMU.GyrX, IMU.GyrY, IMU.GyrZ], unit: rad/s, frame: FRD}\n"
                         "  - euler: {columns: [ATT.Roll, ATT.Pitch, ATT.Yaw], unit: deg, world: NED, body: FRD}\n"
                         "thrusters: {pwm: {columns: [RCOU.C1, RCOU.C2], unit: us}}\n"
                         "signals: {columns: [RCOU.C1, RCOU.C2], units: [us, counts]}\n";

struct OnDisk {
  explicit OnDisk(const std::string& bytes) : path{scratch.path("run.BIN")} { test::write_bytes(path, bytes); }
  [[nodiscard]] recordings::Files files() const { return {{path}, recordings::format_of(path), {}}; }
  test::Scratch scratch;
  std::string path;
};

template <class Sample>
void append(std::vector<Sample>& to, const std::vector<Sample>& from, std::size_t most) {
  CHECK(from.size() <= most);
  if (!to.empty() && !from.empty()) CHECK(to.back().utime <= from.front().utime);
  to.insert(to.end(), from.begin(), from.end());
}

}  // namespace

TEST_CASE(
    "parts: together they are the whole, each later than the one before, and none holds more than was asked for") {
  const OnDisk file{log_of(0)};
  const auto streams = tables::parse_streams(kMap, "map.yaml");
  const auto whole = recordings::import_files(file.files(), streams, {}, true);
  REQUIRE(whole.runs.size() == 1);
  const Recording& all = whole.runs[0].recording;
  CHECK(all.thrusters.size() == 100);
  CHECK(all.ahrs.size() > 1200);
  recordings::PartedImport import{file.files(), streams, {}, true};
  CHECK(import.recordings() == 1);
  Recording sum;
  std::size_t parts = 0;
  constexpr std::size_t kRows = 60;
  for (Recording part; import.next(kRows, part); part = {}, ++parts) {
    append(sum.ahrs, part.ahrs, 2 * kRows);  // of two topics
    append(sum.thrusters, part.thrusters, kRows);
    append(sum.signals, part.signals, 2 * kRows);  // two columns
  }
  CHECK(parts > 10);
  CHECK(import.share() == 1.0);
  REQUIRE(sum.ahrs.size() == all.ahrs.size());
  for (std::size_t i = 0; i < sum.ahrs.size(); ++i) {
    CHECK(sum.ahrs[i].utime == all.ahrs[i].utime);
    CHECK(sum.ahrs[i].has_rates == all.ahrs[i].has_rates);
    CHECK(sum.ahrs[i].w_WB_B == all.ahrs[i].w_WB_B);
  }
  REQUIRE(sum.signals.size() == 200);
  CHECK(sum.signals[0].name == "RCOU.C1");
  CHECK(sum.signals[1].unit == "counts");
  const auto notes = import.finish();
  const auto says = [&](const std::string& words) {
    return std::ranges::any_of(notes, [&](const std::string& note) { return note.find(words) != std::string::npos; });
  };
  CHECK(says("1 messages stand there twice"));
  CHECK(whole.runs[0].notes.size() + whole.notes.size() == notes.size());
}

TEST_CASE("parts: what an attitude turns is held until its turn") {
  const OnDisk file{log_of(0)};
  const auto streams = tables::parse_streams(
      kAbout +
          "ahrs:\n  - rates: {columns: [ATT.Roll, ATT.Pitch, ATT.Yaw], unit: deg/s, frame: NED}\n"
          "    euler: {columns: [ATT.Roll, ATT.Pitch, ATT.Yaw], unit: deg, world: NED, body: FRD}\n"
          "thrusters: {pwm: {columns: [RCOU.C1, RCOU.C2], unit: us}}\n",
      "map.yaml");
  const auto whole = recordings::import_files(file.files(), streams, {}, true);
  recordings::PartedImport import{file.files(), streams, {}, true};
  std::vector<Ahrs> sum;
  std::size_t parts = 0;
  for (Recording part; import.next(10, part); part = {}, ++parts) {
    if (!sum.empty() && !part.ahrs.empty()) CHECK(sum.back().utime <= part.ahrs.front().utime);
    sum.insert(sum.end(), part.ahrs.begin(), part.ahrs.end());
  }
  CHECK(parts >= 10);
  const auto& all = whole.runs.at(0).recording.ahrs;
  REQUIRE(sum.size() == all.size());
  for (std::size_t i = 0; i < sum.size(); ++i) CHECK(sum[i].w_WB_B == all[i].w_WB_B);
}

TEST_CASE("names of topics: one without a number is the only one, or the first, which is said") {
  CHECK(recordings::names_of_topic("IMU[1]") == std::vector<std::string>{"IMU[1]", "IMU"});
  CHECK(recordings::names_of_topic("IMU") == std::vector<std::string>{"IMU", "IMU[0]"});
  CHECK(recordings::names_of_topic("a[x]")[1] == "a[x][0]");
  CHECK(recordings::instance_of("IMU[12]") == 12);
  const auto rates_of = [](int instances, const std::string& name, std::vector<std::string>& notes) {
    const OnDisk file{log_of(instances)};
    std::string map = kAbout + "ahrs: {rates: {columns: [", separator;
    for (const char* axis : {"X", "Y", "Z"}) {
      map += separator + "'" + name + ".Gyr" + axis + "'";
      separator = ", ";
    }
    const auto imported = recordings::import_files(
        file.files(), tables::parse_streams(map + "], unit: rad/s, frame: FRD}}\n", "map.yaml"), {}, true);
    notes = imported.notes;
    REQUIRE(imported.runs.at(0).recording.ahrs.size() == 1000);
    return imported.runs[0].recording.ahrs.front().w_WB_B.z();
  };
  std::vector<std::string> notes;
  CHECK(rates_of(0, "IMU", notes) == 0.0);
  CHECK(notes.empty());
  CHECK(rates_of(1, "IMU", notes) == 0.0);
  REQUIRE(notes.size() == 1);
  CHECK(notes[0].find("'IMU.GyrX' is taken from IMU[0]") != std::string::npos);
  CHECK(rates_of(3, "IMU", notes) == 0.0);  // though the third comes first in the file
  REQUIRE(notes.size() == 1);
  CHECK(notes[0].find("the first of 3") != std::string::npos);
  CHECK(rates_of(3, "IMU[2]", notes) == 2.0);
  CHECK(notes.empty());
  CHECK(rates_of(0, "IMU[0]", notes) == 0.0);  // a map made for a log of several, on one of a single one
  REQUIRE(notes.size() == 1);
  CHECK(notes[0].find("is taken from IMU") != std::string::npos);
  CHECK_THROWS_WITH_AS(static_cast<void>(rates_of(0, "IMU[1]", notes)), doctest::Contains("is of no topic"),
                       InputError);
}

}  // namespace fathom
