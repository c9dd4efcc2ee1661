// The time of a table's rows: seconds, other units, seconds beside nanoseconds, dates as text; and whether another
// column that looks like a clock goes as fast.
#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <optional>
#include <span>
#include <string_view>
#include <unordered_map>
#include <utility>

#include "common/base/error.hpp"
#include "common/base/statistics.hpp"
#include "common/tables/date_text.hpp"
#include "common/tables/readers.hpp"

namespace fathom::tables {
namespace {

constexpr double kMaxSeconds = 9e9;      // beyond, a double no longer resolves a microsecond
constexpr double kGapPeriods = 5.0;      // a step of this many median periods is reported as a gap
constexpr double kSlowestStep = 2.0;     // s between rows: slower, a finer unit is likelier than so slow a recorder
constexpr double kFastestStep = 1e-3;    // s between rows: no recorder of a vehicle's motion writes faster
constexpr double kSlowestMotion = 60.0;  // s between rows: slower, no vehicle's motion is seen
constexpr double kDay = 86400.0;         // s
constexpr double kClocksDiffer = 0.005;  // of the rate: no crystal is off so far
constexpr double kFewestSteps = 20.0;    // of a clock that may be written in whole seconds
constexpr std::array<std::pair<const char*, double>, 4> kUnits{{{"s", 1.0}, {"ms", 1e-3}, {"us", 1e-6}, {"ns", 1e-9}}};
constexpr auto kFinerUnits = std::span{kUnits}.subspan<1>();

std::string lower(std::string_view text) {
  std::string copy(text);
  for (char& c : copy) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return copy;
}

std::string in_seconds(double seconds) {
  const std::string text = std::to_string(std::round(seconds * 1e3) * 1e-3);
  return text.substr(0, text.size() - 3) + " s";
}

/// "time: {column: t, unit: ns}" for the map.
std::string written(const Column& column, const char* unit) {
  return std::string("Say so in the map") + (column.where.empty() ? " (--map)" : "") +
         ": time: {column: " + column.name + ", unit: " + unit + "}";
}

std::string complaint_of(const CsvTable& table, const Column& column) {
  return (column.where.empty() ? "" : column.where + ": ") + table.path + ": column '" + column.name +
         "': the median step between rows is ";
}

/// Refuses rows too far apart to be seconds, before anything is laid on a grid that long.
/// `dated`: by their size or as dates, they can be nothing else than they are said to be (a glider writes its flight
/// every four seconds).
void check_step(const CsvTable& table, const Column& column, double factor, bool dated, double median_step) {
  if (median_step <= (dated ? kSlowestMotion : kSlowestStep)) return;
  std::string remedy = "is its unit right?";
  for (const auto& [unit, finer] : kFinerUnits) {
    if (factor != 1.0 || finer * median_step > kSlowestStep) continue;
    remedy = std::string("is it in ") + unit + "? " + written(column, unit);
    break;
  }
  throw InputError(complaint_of(table, column) + in_seconds(median_step) +
                   ", too slow for the motion of any vehicle; " + remedy);
}

/// The unit in which a column counts from 1970 whose map names a finer one; null: none. `first`: s, by the map's.
const char* counts_from_1970_in(double factor, double first) {
  for (const auto& [unit, coarser] : kUnits) {
    if (coarser > 2.0 * factor && is_since_1970(coarser / factor * first)) return unit;
  }
  return nullptr;
}

/// Refuses what counts from 1970 in a coarser unit than the map names: its rows would lie too close.
/// `unit`: that one.
void check_epoch(const CsvTable& table, const Column& column, const char* unit, double median_step) {
  if (unit == nullptr || median_step <= 0.0 || median_step >= kFastestStep) return;
  throw InputError(complaint_of(table, column) + std::to_string(std::lround(1e6 * median_step)) +
                   " us by its unit, faster than any recorder writes; it counts from 1970 in " + unit + ". " +
                   written(column, unit));
}

/// Notes the longest gap; the median step, in s.
double report_longest_gap(const Paged<Utime>& utime, std::vector<std::string>& notes) {
  if (utime.size() < 3) return 0.0;
  // Counted by their length, those above a second to a millisecond: at most some millions, however many rows there are.
  constexpr Utime kSecond = 1'000'000, kCoarse = 1'000;
  std::unordered_map<Utime, std::size_t> counts;
  Utime longest = 0, after = utime[0];
  for (std::size_t i = 0; i + 1 < utime.size(); ++i) {
    const Utime before = utime[i], step = utime[i + 1] - before;
    ++counts[step < kSecond ? step : step / kCoarse * kCoarse];
    if (step <= longest) continue;
    longest = step;
    after = before;
  }
  const double gap = static_cast<double>(longest) * 1e-6;
  const double begin = seconds_between(0, after);
  std::vector<std::pair<Utime, std::size_t>> sorted(counts.begin(), counts.end());
  std::ranges::sort(sorted);
  auto middle = sorted.begin();
  for (std::size_t below = middle->second; below <= (utime.size() - 1) / 2; below += middle->second) ++middle;
  const double typical = static_cast<double>(middle->first) * 1e-6;
  if (gap > kGapPeriods * typical) {
    notes.push_back("time: the longest gap is " + in_seconds(gap) + ", after " + in_seconds(begin));
  }
  return typical;
}

/// The column of nanoseconds beside one of whole seconds, "stamp.nanosec" beside "stamp.sec"; empty when there is none.
std::string nanoseconds_beside(const CsvTable& table, const Column& seconds, const Paged<double>& values) {
  const auto whole = [](double value) { return std::isnan(value) || value == std::floor(value); };
  if (!std::ranges::all_of(values, whole)) return {};
  for (const auto& [whole_name, fine_name] : {std::pair{"sec", "nanosec"},
                                              {"secs", "nsecs"},
                                              {"sec", "nsec"},
                                              {"s", "ns"},
                                              {"seconds", "nanoseconds"},
                                              {"secs", "nanosecs"}}) {
    const std::string name = lower(seconds.name);
    if (!name.ends_with(whole_name)) continue;
    const std::string prefix = seconds.name.substr(0, name.size() - std::string_view(whole_name).size());
    if (!prefix.empty() && std::isalpha(static_cast<unsigned char>(prefix.back())) != 0) continue;
    for (const std::string& other : table.names) {
      if (lower(other) == lower(prefix) + fine_name) return other;
    }
  }
  return {};
}

/// Seconds of every row, NaN where a part is missing.
class TimeColumn {
 public:
  TimeColumn(const CsvTable& table, Resolver& resolve, const ColumnMap& map, std::vector<std::string>& notes)
      : columns_(map.time.columns), factors_(map.time_factors) {
    factors_.resize(columns_.size(), map.time.factor);
    const Paged<double>& first = *resolve(columns_.front());
    if (columns_.size() == 1) {
      if (const std::string fine = nanoseconds_beside(table, columns_.front(), first);
          !fine.empty() && factors_.front() == 1.0) {
        columns_.push_back({fine, columns_.front().where});
        factors_.push_back(1e-9);
        notes.push_back("time: '" + columns_.front().name + "' [s] and '" + fine + "' [ns] are added");
      }
      find_epoch(first, notes);
    }
    for (const Column& column : columns_) data_.push_back(resolve(column));
    for (std::size_t i = 0; i < data_.size(); ++i) {
      const Cells cells = table.cells_of(table.index(data_[i]));
      if (cells != Cells::kNumbers) factors_[i] = 1.0;
      clock_only_ = clock_only_ && cells == Cells::kTimesOfDay;
      dates_ = dates_ || cells == Cells::kDates;
    }
    for (std::size_t row = 0; row < table.rows() && !dates_; ++row) {
      const double first_time = seconds(row);
      if (!std::isfinite(first_time)) continue;
      dated_ = is_since_1970(first_time);
      break;
    }
    dated_ = dated_ || dates_;
    if (dates_ && table.zoneless_dates) notes.emplace_back("time: dates without a zone are taken as UTC");
  }

  [[nodiscard]] double seconds(std::size_t row) const {
    double sum = 0.0;
    for (std::size_t i = 0; i < data_.size(); ++i) sum += factors_[i] * (*data_[i])[row];
    return sum;
  }
  [[nodiscard]] const Column& first() const { return columns_.front(); }
  [[nodiscard]] double factor() const { return factors_.front(); }
  /// Seconds since 1970, whatever they were written as.
  [[nodiscard]] bool dated() const { return dated_; }
  /// Nothing but times of day: past midnight they begin again.
  [[nodiscard]] bool begins_again() const { return clock_only_; }
  [[nodiscard]] bool is(const std::string& name) const {
    return std::ranges::any_of(columns_, [&](const Column& column) { return column.name == name; });
  }

 private:
  /// Without a map: numbers that can be nothing but an epoch in ms, us or ns.
  void find_epoch(const Paged<double>& values, std::vector<std::string>& notes) {
    if (!columns_.front().where.empty() || factors_.front() != 1.0 || columns_.size() != 1) return;
    const auto first = std::ranges::find_if(values, [](double value) { return std::isfinite(value); });
    if (first == values.end()) return;
    for (const auto& [unit, finer] : kFinerUnits) {
      const double seconds = finer * *first;
      if (*first < kMaxSeconds || !is_since_1970(seconds)) continue;
      factors_.front() = finer;
      notes.push_back("time: '" + columns_.front().name + "' is read as " + unit + " since 1970");
    }
  }

  std::vector<Column> columns_;
  std::vector<double> factors_;
  std::vector<ColumnData> data_;
  bool clock_only_{true}, dates_{false}, dated_{false};
};

/// Another column that is a clock by its cells or its name, and does not go as fast: a nominal counter is no time.
void compare_clocks(const CsvTable& table, const TimeColumn& time, const Rows& rows, std::vector<std::string>& notes) {
  for (std::size_t c = 0; c < table.names.size(); ++c) {
    const std::string name = lower(table.names[c]);
    const bool text = table.cells_of(c) != Cells::kNumbers;
    const bool named = name == "time" || name == "timestamp" || name == "datetime" || name == "utc" || name == "clock";
    if ((!text && !named) || time.is(table.names[c])) continue;
    std::optional<std::pair<double, double>> first;  // s, unit of the column
    std::pair<double, double> last;
    double steps = 0.0;
    for (std::size_t k = 0; k < rows.index.size(); ++k) {
      const double value = table.columns[c][rows.index[k]];
      if (!std::isfinite(value) || (first && value <= last.second)) continue;
      last = {seconds_between(0, rows.utime[k]), value};
      if (!first) first = last;
      ++steps;
    }
    if (steps < kFewestSteps) continue;
    const double here = last.first - first->first, there = last.second - first->second;
    double rate = there / here;
    if (!text) {
      for (const auto& [unit, finer] : kFinerUnits) {
        if (std::abs(std::log(finer * rate)) < std::abs(std::log(rate))) rate *= finer;
      }
    }
    if (std::abs(rate - 1.0) < kClocksDiffer || rate > 2.0 || rate < 0.5) continue;
    char text_of[160];
    std::snprintf(text_of, sizeof text_of,
                  "time: by '%s' the run lasts %.1f s, by '%s' %.1f s (%+.1f %%): ", time.first().name.c_str(), here,
                  table.names[c].c_str(), rate * here, 100.0 * (rate - 1.0));
    notes.push_back(text_of +
                    std::string("one of them is no clock; velocities and thrust lags follow the one that is "
                                "used. To use the other: time: {column: ") +
                    table.names[c] + ", unit: " + (text ? "date" : "s") + "} in the map");
  }
}

}  // namespace

Rows read_time(const CsvTable& table, Resolver& resolve, const ColumnMap& map, std::vector<std::string>& notes) {
  const TimeColumn time(table, resolve, map, notes);
  Rows rows;
  std::size_t missing = 0;
  std::size_t falling = 0;
  std::size_t first_falling = 0;
  double days = 0.0, before = 0.0;
  for (std::size_t row = 0; row < table.rows(); ++row) {
    double seconds = time.seconds(row);
    if (!std::isfinite(seconds)) {
      ++missing;
      continue;
    }
    if (time.begins_again()) {
      if (!rows.utime.empty() && seconds < before - 0.5 * kDay) days += kDay;
      before = seconds;
      seconds += days;
    }
    if (std::abs(seconds) > kMaxSeconds) {
      std::string remedy = "is its unit right?";
      for (const auto& [unit, finer] : kFinerUnits) {
        if (time.factor() == 1.0 && is_since_1970(seconds * finer))
          remedy = std::string("is it in ") + unit + "? " + written(time.first(), unit);
      }
      throw InputError(table.where(row) + ": time " + std::to_string(seconds) + " s is too large; " + remedy);
    }
    const Utime utime = utime_after(0, seconds);
    if (!rows.utime.empty() && utime <= rows.utime.back()) {
      if (falling++ == 0) first_falling = row;
      continue;
    }
    rows.index.push_back(row);
    rows.utime.push_back(utime);
  }
  const char* unit =
      rows.utime.empty() ? nullptr : counts_from_1970_in(time.factor(), seconds_between(0, rows.utime.front()));
  if (falling > 0 && 2 * falling >= table.rows()) {
    const std::string remedy =
        unit != nullptr ? std::string{"it counts from 1970 in "} + unit + ". " + written(time.first(), unit)
                        : "is it the time column, and is its unit right? Seconds and nanoseconds in two columns: "
                          "time: {columns: [SECONDS, NANOSECONDS], units: [s, ns]} in the map";
    throw InputError(table.where(first_falling) + ": time does not rise here nor in " + std::to_string(falling - 1) +
                     " more of " + std::to_string(table.rows()) + " rows; " + remedy);
  }
  if (missing > 0) notes.push_back("time: " + std::to_string(missing) + " rows dropped (empty or NaN)");
  if (falling > 0) {
    notes.push_back("time: " + std::to_string(falling) + " rows dropped because time did not rise, first at " +
                    table.where(first_falling));
  }
  const double typical = report_longest_gap(rows.utime, notes);
  if (time.first().name == kOwnTime) return rows;  // a topic's own time is known to be one
  check_step(table, time.first(), time.factor(), time.dated(), typical);
  check_epoch(table, time.first(), unit, typical);
  compare_clocks(table, time, rows, notes);
  return rows;
}

}  // namespace fathom::tables
