#include "common/tables/likely_time.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>

#include "common/tables/date_text.hpp"
#include "common/tables/map_writer.hpp"

namespace fathom::tables {
namespace {

/// The unit in which a column counts from 1970, or in which its rows lie as far apart as those of a recording do; null
/// where it does not rise.
const char* likely_unit(const Paged<double>& column) {
  constexpr double kLongest = 2.0, kLongestDated = 60.0;  // s between rows
  std::vector<double> steps;
  for (std::size_t i = 1; i < std::min<std::size_t>(column.size(), 1000); ++i) {
    if (column[i] > column[i - 1]) steps.push_back(column[i] - column[i - 1]);
  }
  if (steps.empty()) return nullptr;
  const auto middle = steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2);
  std::ranges::nth_element(steps, middle);
  const auto first = std::ranges::find_if(column, [](double t) { return std::isfinite(t); });
  const char* by_step = nullptr;
  double factor = 1.0;
  for (const char* unit : {"s", "ms", "us", "ns"}) {
    if (first != column.end() && is_since_1970(factor * *first) && factor * *middle <= kLongestDated) return unit;
    if (by_step == nullptr && factor * *middle <= kLongest) by_step = unit;
    factor *= 1e-3;
  }
  return by_step;
}

bool is_named_so(const std::string& name) {
  std::string small = name;
  std::ranges::transform(small, small.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return small == "t" || small == "date" || small == "utc" || small == "sec" || small == "seconds" ||
         small.find("time") != std::string::npos || small.find("stamp") != std::string::npos ||
         small.starts_with("elapsed");
}

/// A date that is the same all day: its time of day stands in another column.
bool whole_days(const Paged<double>& column) {
  constexpr double kDay = 86400.0;  // s
  const auto end = column.begin() + static_cast<std::ptrdiff_t>(std::min<std::size_t>(column.size(), 1000));
  return std::all_of(column.begin(), end, [](double t) { return !std::isfinite(t) || std::fmod(t, kDay) == 0.0; });
}

/// A date and a time of day, each in a column of its own.
std::optional<LikelyTime> in_two(const CsvTable& table) {
  std::optional<std::size_t> date, time;
  for (std::size_t i = 0; i < table.names.size(); ++i) {
    if (!table.faults[i].empty()) continue;
    if (!date && table.cells_of(i) == Cells::kDates && whole_days(table.columns[i])) date = i;
    if (!time && table.cells_of(i) == Cells::kTimesOfDay) time = i;
  }
  if (!date || !time) return std::nullopt;
  return LikelyTime{{table.names[*date], table.names[*time]},
                    "time: {columns: [" + written_name(table.names[*date]) + ", " + written_name(table.names[*time]) +
                        "], units: [date, date]}"};
}

}  // namespace

std::optional<LikelyTime> likely_time(const CsvTable& table) {
  if (auto both = in_two(table)) return both;
  for (std::size_t i = 0; i < table.names.size(); ++i) {
    const std::string& name = table.names[i];
    if (!is_named_so(name)) continue;
    for (const char* rest : {"nanosec", "nsec", "nsecs"}) {  // ROS: seconds and nanoseconds beside them
      const std::string other = name.substr(0, name.find_last_of("._") + 1) + rest;
      if (other == name || table.find(other) == nullptr) continue;
      return LikelyTime{{name, other},
                        "time: {columns: [" + written_name(name) + ", " + written_name(other) + "], units: [s, ns]}"};
    }
    const char* unit = table.cells_of(i) == Cells::kNumbers ? likely_unit(table.columns[i]) : "date";
    if (unit == nullptr || !table.faults[i].empty()) continue;
    return LikelyTime{{name}, "time: {column: " + written_name(name) + ", unit: " + unit + "}"};
  }
  return std::nullopt;
}

}  // namespace fathom::tables
