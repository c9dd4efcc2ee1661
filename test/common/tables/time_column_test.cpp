// Time as people have it: other units, two columns, dates, and a counter beside a clock.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "common/base/error.hpp"
#include "common/tables/date_text.hpp"
#include "common/tables/import.hpp"

using namespace fathom;
using namespace fathom::tables;

namespace {

const std::string kAbout = "source: nobody\nlicence: none\n";
const std::string kDepth = "depth: {column: z, unit: m, direction: down}\n";

Imported import_text(const std::string& csv, const std::string& time) {
  return import_table(parse_csv(csv, "run.csv"),
                      ColumnMap::parse(kAbout + "time: " + time + "\n" + kDepth, "map.yaml"));
}
Imported canonical(const std::string& csv) {
  const CsvTable table = parse_csv(csv, "run.csv");
  return import_table(table, canonical_map(table));
}
bool noted(const Imported& imported, const std::string& part) {
  return std::ranges::any_of(imported.notes, [&](const auto& note) { return note.find(part) != std::string::npos; });
}
Utime second_stamp(const Imported& imported) { return imported.recording.depth.at(1).utime; }

double seconds_of(const char* text) {
  const auto date = read_date(text);
  return date ? date->seconds : std::nan("");
}

constexpr Utime kStamp = 1'748'338'850'223'456;  // us: what the tables below mean in their second row
constexpr Utime kRounding = 1;                   // us: a double of this size holds a quarter of one

}  // namespace

TEST_CASE("date text: forms that loggers write, by hand") {
  CHECK(seconds_of("1970-01-02") == 86400.0);
  CHECK(seconds_of("2024-05-27T09:40:00.000000Z") == 1716802800.0);  // date -u -d 2024-05-27T09:40:00Z +%s
  CHECK(seconds_of("2024-05-27 09:40:00.250") == 1716802800.25);
  CHECK(seconds_of("2024-05-27T11:40:00+02:00") == 1716802800.0);
  CHECK(seconds_of("2024-05-27T04:10-0530") == 1716802800.0);
  CHECK(seconds_of("2024/05/27 09:40:00") == 1716802800.0);
  CHECK(seconds_of("20240527T094000") == 1716802800.0);
  CHECK(seconds_of("27.05.2024 09:40:00") == 1716802800.0);
  CHECK(seconds_of("09:40:00,5") == 34800.5);
  for (const char* none : {"05/06/2024 09:40:00", "2024-02-30", "2024-05-27T25:61:00", "2024-05-27 09:40:00 CEST",
                           "12:3", "20240527", "2024-5-27", "surge", ""}) {
    CAPTURE(none);
    CHECK_FALSE(read_date(none).has_value());
  }
}

TEST_CASE("time: nanoseconds, by the map, and by their size without one") {
  const std::string csv = "t,z\n1748338850123456789,1\n1748338850223456789,2\n";
  CHECK(std::abs(second_stamp(import_text(csv, "{column: t, unit: ns}")) - kStamp) <= kRounding);
  const Imported plain = canonical(csv);
  CHECK(std::abs(second_stamp(plain) - kStamp) <= kRounding);
  CHECK(noted(plain, "time: 't' is read as ns since 1970"));
  CHECK(std::abs(second_stamp(canonical("t,z\n1748338850123.456,1\n1748338850223.456,2\n")) - kStamp) <= kRounding);
  CHECK_THROWS_WITH_AS(import_text(csv, "{column: t, unit: s}"), doctest::Contains("unit: ns}"), InputError);
}

TEST_CASE("time: seconds since 1970 that the map calls milliseconds are refused, with the unit that they are in") {
  const auto complaint = [](const std::string& csv, const std::string& time) {
    try {
      static_cast<void>(import_text(csv, time));
    } catch (const InputError& error) {
      return std::string{error.what()};
    }
    return std::string{"no complaint"};
  };
  const std::string dated = "t,z\n1748338850.18,1\n1748338850.22,2\n1748338850.26,3\n1748338850.30,4\n";
  CHECK(complaint(dated, "{column: t, unit: s}") == "no complaint");
  const std::string told = complaint(dated, "{column: t, unit: ms}");
  CHECK(told.find("the median step between rows is 40 us by its unit") != std::string::npos);
  CHECK(told.ends_with("it counts from 1970 in s. Say so in the map: time: {column: t, unit: s}"));
  // Where they come to lie so close that none of them rises.
  for (const char* unit : {"us", "ns"}) {
    const std::string close = complaint(dated, std::string{"{column: t, unit: "} + unit + "}");
    CHECK(close.find("time does not rise") != std::string::npos);
    CHECK(close.ends_with("it counts from 1970 in s. Say so in the map: time: {column: t, unit: s}"));
  }
  // Milliseconds of a computer that was on for twenty days are what they are said to be.
  CHECK(complaint("t,z\n1748338850,1\n1748338890,2\n1748338930,3\n1748338970,4\n", "{column: t, unit: ms}") ==
        "no complaint");
}

TEST_CASE("time: seconds beside nanoseconds are added, stated or found by their names") {
  const std::string csv = "stamp.sec,stamp.nanosec,z\n1748338850,123456789,1\n1748338850,223456789,2\n";
  const Imported stated = import_text(csv, "{columns: [stamp.sec, stamp.nanosec], units: [s, ns]}");
  CHECK(std::abs(second_stamp(stated) - kStamp) <= kRounding);
  const Imported found = import_text(csv, "{column: stamp.sec, unit: s}");
  CHECK(std::abs(second_stamp(found) - kStamp) <= kRounding);
  CHECK(noted(found, "'stamp.sec' [s] and 'stamp.nanosec' [ns] are added"));
  CHECK_THROWS_WITH_AS(import_text("sec,frac,z\n1,0,1\n1,1,1\n1,2,1\n1,3,2\n", "{column: sec, unit: s}"),
                       doctest::Contains("units: [s, ns]"), InputError);
  CHECK_THROWS_WITH_AS(import_text(csv, "{columns: [stamp.sec, stamp.nanosec], units: [s]}"),
                       doctest::Contains("map.yaml:3: 'units' needs one unit for each"), InputError);
}

TEST_CASE("time: dates, a date and a time of day, and midnight") {
  CHECK(second_stamp(canonical("t,z\n2025-05-27T09:40:50.123456Z,1\n2025-05-27T09:40:50.223456Z,2\n")) ==
        1'748'338'850'223'456);
  const Imported zoneless = canonical("t,z\n2025-05-27 09:40:50.1,1\n2025-05-27 09:40:50.2,2\n");
  CHECK(noted(zoneless, "dates without a zone are taken as UTC"));
  const Imported parts = import_text("day,hour,z\n2025-05-27,09:40:50.0,1\n2025-05-27,09:40:50.5,2\n",
                                     "{columns: [day, hour], units: [date, date]}");
  CHECK(second_stamp(parts) == 1'748'338'850'500'000);
  const Imported night = canonical("t,z\n23:59:59.5,1\n00:00:00.5,2\n00:00:01.5,3\n");
  REQUIRE(night.recording.depth.size() == 3);
  CHECK(night.recording.depth[1].utime - night.recording.depth[0].utime == 1'000'000);
}

TEST_CASE("time: a counter that does not go as fast as the clock beside it is told with both durations") {
  const auto table = [](double rate) {
    std::string csv = "t,DateTime,depth\n";
    for (int k = 0; k < 600; ++k) {
      const double clock = 0.1 * rate * k;
      char row[80];
      std::snprintf(row, sizeof row, "%.3f,2025-07-24 15:%02d:%06.3f,1\n", 0.1 * k, static_cast<int>(clock / 60.0),
                    std::fmod(clock, 60.0));
      csv += row;
    }
    return csv;
  };
  CHECK(noted(canonical(table(1.095)), "by 't' the run lasts 59.9 s, by 'DateTime' 65.6 s (+9.5 %)"));
  CHECK_FALSE(noted(canonical(table(1.0)), "the run lasts"));
}
