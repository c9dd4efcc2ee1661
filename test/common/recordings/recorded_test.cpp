// Recordings of real vehicles against what independent decoders read in them: every topic, every number.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

#include "common/recordings/import.hpp"
#include "test/support/heard.hpp"
#include "test/support/scratch.hpp"

namespace fathom {
namespace {

// Decoders print nine digits of what are floats mostly; means are sums of many.
constexpr double kDigits = 2e-6;

std::vector<std::string> cells(const std::string& line) {
  std::vector<std::string> all;
  std::istringstream text{line};
  for (std::string cell; std::getline(text, cell, ',');) all.push_back(cell);
  all.resize(6);
  return all;
}

bool near(double a, double b, double scale) { return std::abs(a - b) <= kDigits * scale + 1e-12; }

void compare(const std::filesystem::path& expected) {
  const std::string name = expected.string();
  const std::string recording = name.substr(0, name.size() - std::string{".expected.csv"}.size());
  CAPTURE(recording);
  const test::HeardFile file = test::hear_file(recording);
  CHECK(file.damage.none());
  std::ifstream table{expected};
  std::string line;
  std::getline(table, line);
  while (std::getline(table, line)) {
    CAPTURE(line);
    const std::vector<std::string> row = cells(line);
    if (!file.heard.has(row[0])) {
      FAIL_CHECK("topic is missing");
      continue;
    }
    const test::HeardTopic& topic = file.heard.of(row[0]);
    if (row[1].empty()) {
      CHECK(topic.stamps.size() == std::stoul(row[2]));
      if (row[3].empty()) continue;
      std::int64_t least = std::stoll(row[3]), greatest = std::stoll(row[4]);
      for (const recordings::Stamp& stamp : topic.stamps) {
        if (stamp.log == recordings::kNoTime) continue;
        least = std::min(least, stamp.log);
        greatest = std::max(greatest, stamp.log);
        CHECK(stamp.log >= std::stoll(row[3]));
      }
      if (std::stoll(row[3]) > 0) CHECK(least == std::stoll(row[3]));
      CHECK(greatest == std::stoll(row[4]));
      continue;
    }
    std::vector<double> values = topic.column(row[1]);
    std::erase_if(values, [](double value) { return !std::isfinite(value); });
    CHECK(values.size() == std::stoul(row[2]));
    if (values.empty()) continue;
    const double least = *std::ranges::min_element(values), greatest = *std::ranges::max_element(values);
    double mean = 0.0;
    for (const double value : values) mean += value / static_cast<double>(values.size());
    const double scale = std::max(std::abs(least), std::abs(greatest));
    CHECK(near(least, std::stod(row[3]), scale));
    CHECK(near(greatest, std::stod(row[4]), scale));
    CHECK(near(mean, std::stod(row[5]), scale));
  }
}

}  // namespace

TEST_CASE("recordings: every number of recorded files is what independent decoders read") {
  int files = 0;
  for (const auto& entry :
       std::filesystem::directory_iterator{std::string{FATHOM_SOURCE_DIR} + "/test/data/recordings"}) {
    if (!entry.path().string().ends_with(".expected.csv")) continue;
    ++files;
    compare(entry.path());
  }
  CHECK(files >= 9);
}

TEST_CASE("recordings: the sticks of a real ArduSub log become the pulses of eight motors, and a doubled file is one") {
  const test::Scratch scratch;
  const std::string log = std::string{FATHOM_SOURCE_DIR} + "/test/data/recordings/ardusub_12s.BIN";
  const auto sticks = tables::parse_streams(
      "source: s\nlicence: l\nthrusters:\n  sticks: {frame: vectored-6dof, columns: [RCIN.C1, RCIN.C2, RCIN.C3, "
      "RCIN.C4, "
      "RCIN.C5, RCIN.C6], neutral: 1500 us, full: 400 us}\n",
      "map.yaml");
  const auto import = [&](const std::string& path) {
    return recordings::import_files({{path}, recordings::format_of(path)}, sticks, {}, true);
  };
  const auto thrusters = import(log).runs.at(0).recording.thrusters;
  REQUIRE(thrusters.size() == 120);
  // The first row has yaw at 1493 and forward at 1499: factors of VECTORED_6DOF give -7 and -1 us with their signs.
  const std::vector<double> first{1494.0, 1508.0, 1506.0, 1492.0, 1500.0, 1500.0, 1500.0, 1500.0};
  for (std::size_t i = 0; i < first.size(); ++i) CHECK(thrusters[0].pwm_us[i] == doctest::Approx(first[i]));

  // A bag whose index was made anew tells its messages twice; here a whole file stands twice in one of its formats.
  const std::string mcap = std::string{FATHOM_SOURCE_DIR} + "/test/data/recordings/beluga_15s_lz4.mcap";
  const auto dvl = tables::parse_streams(
      "source: s\nlicence: l\ndvl: {velocity: {columns: [/dvl/twist.twist.twist.linear.x, "
      "/dvl/twist.twist.twist.linear.y, /dvl/twist.twist.twist.linear.z], unit: m/s, frame: FLU}}\n",
      "map.yaml");
  const auto count = [&](const std::string& path, std::vector<std::string>& notes) {
    const auto imported = recordings::import_files({{path}, recordings::format_of(path)}, dvl, {}, true);
    notes = imported.runs.at(0).notes;
    return imported.runs[0].recording.dvl.size();
  };
  std::vector<std::string> notes;
  const std::size_t once = count(mcap, notes);
  const std::string bytes = test::read_bytes(mcap);
  test::write_bytes(scratch.path("twice.mcap"), bytes + bytes);
  CHECK(count(scratch.path("twice.mcap"), notes) == once);
  CHECK(std::ranges::any_of(notes, [](const std::string& note) {
    return note.find("messages stand there twice (same time, same numbers)") != std::string::npos;
  }));
}

}  // namespace fathom
