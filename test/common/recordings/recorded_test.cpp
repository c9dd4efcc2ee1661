// Recordings of real vehicles against what independent decoders read in them: every topic, every number.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

#include "test/support/heard.hpp"

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

}  // namespace fathom
