#include "common/recordings/arrays/arrays.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <map>
#include <optional>

namespace fathom::recordings::arrays {
namespace {

constexpr double kRising = 0.99;      // part of the steps that must not fall
constexpr double kUnixDays = 719529;  // MATLAB's date of 1970-01-01
constexpr std::size_t kMostColumns = 256;
constexpr std::size_t kMostNamed = 12;

std::string holder_of(const std::string& path) {
  const std::size_t end = path.find_last_of("./");
  return end == std::string::npos ? "" : path.substr(0, end);
}

std::string own_name(const std::string& path) {
  const std::size_t end = path.find_last_of("./");
  return end == std::string::npos ? path : path.substr(end + 1);
}

/// Length of what is a vector; 0 for what is none.
std::size_t length_of(const Array& array) {
  std::size_t length = 1;
  for (const std::size_t side : array.shape) {
    if (side != 1 && length != 1) return 0;
    if (side != 1) length = side;
  }
  return array.shape.empty() || array.shape.size() > 2 ? 0 : length;
}

/// How to read a time, in factors to us and what is taken off before.
struct TimeUnit {
  const char* name;
  double offset, to_us;
};

TimeUnit unit_of(const Array& array) {
  std::string name = own_name(array.path);
  std::ranges::transform(name, name.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  const double size = std::abs(array.values[array.values.size() / 2]);
  const double step = std::abs(array.values.back() - array.values.front()) / static_cast<double>(array.values.size());
  if (array.date) return {"s", 0.0, 1e6};
  if (size > 6e5 && size < 9e5 && step < 0.1) return {"days since year 0", kUnixDays, 86400e6};
  if (name.ends_with("_ns") || size > 1e17) return {"ns", 0.0, 1e-3};
  if (name.ends_with("_us") || name == "utime" || size > 1e14) return {"us", 0.0, 1.0};
  if (name.ends_with("_ms") || size > 1e11) return {"ms", 0.0, 1e3};
  return {"s", 0.0, 1e6};
}

/// How much like a time an array is: less is more; nothing for what is none.
std::optional<int> rank_of(const Array& array) {
  std::string name = own_name(array.path);
  std::ranges::transform(name, name.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  constexpr std::array kNames{"t",      "time",  "times", "timestamp", "timestamps", "stamp",
                              "stamps", "utime", "tout",  "seconds",   "sec"};
  const auto known = std::ranges::find(kNames, name);
  if (known == kNames.end() && !name.starts_with("t_") && !name.starts_with("time_")) return std::nullopt;
  if (length_of(array) < 2 || array.values.size() < 2) return std::nullopt;
  std::size_t rising = 0;
  for (std::size_t i = 1; i < array.values.size(); ++i) rising += array.values[i] >= array.values[i - 1] ? 1 : 0;
  if (static_cast<double>(rising) < kRising * static_cast<double>(array.values.size() - 1)) return std::nullopt;
  if (!(array.values.back() > array.values.front())) return std::nullopt;
  const int rank = static_cast<int>(known - kNames.begin());
  return rank + (unit_of(array).offset != 0.0 ? 100 : 0);  // days resolve 10 us at best
}

/// A column of an array along its time.
struct Column {
  const Array* array{};
  std::size_t first{}, step{};
};

struct Group {
  const Array* time{};
  int rank{};
  std::vector<Column> columns;
  Topic topic;
};

}  // namespace

void say(const std::vector<Array>& arrays, Sink& sink, Damage& damage) {
  std::map<std::pair<std::string, std::size_t>, Group> groups;  // by what holds the time, and its length
  for (const Array& array : arrays) {
    const std::optional<int> rank = rank_of(array);
    if (!rank) continue;
    Group& group = groups[{holder_of(array.path), length_of(array)}];
    if (group.time == nullptr || *rank < group.rank) {
      group.time = &array;
      group.rank = *rank;
    }
  }
  std::string others;
  std::size_t more = 0;
  for (const Array& array : arrays) {
    const std::size_t rows = array.shape.empty() ? 0 : array.shape[0];
    const std::size_t columns = array.shape.size() == 2 ? array.shape[1] : 1;
    bool taken = false;
    for (std::string holder = holder_of(array.path); array.shape.size() <= 2 && !taken; holder = holder_of(holder)) {
      for (const bool upright : {true, false}) {
        const auto found = groups.find({holder, upright ? rows : columns});
        const std::size_t width = upright ? columns : rows;
        if (found == groups.end() || width > kMostColumns) continue;
        Group& group = found->second;
        const std::string name = holder.empty() ? array.path : array.path.substr(holder.size() + 1);
        for (std::size_t k = 0; k < width; ++k) {
          group.columns.push_back({&array, upright ? k * rows : k, upright ? 1 : rows});
          group.topic.fields.push_back({name + (width > 1 ? "[" + std::to_string(k) + "]" : ""),
                                        &array == group.time ? std::string{unit_of(array).name} + ", the time" : ""});
        }
        taken = true;
        break;
      }
      if (holder.empty()) break;
    }
    if (taken || array.values.size() < 2) continue;
    if (++more <= kMostNamed) others += (others.empty() ? "" : ", ") + array.path;
  }
  if (more > 0)
    damage.add("list of arrays that no time goes with (a vector called t or time, rising, and as long as they are): " +
               others + (more > kMostNamed ? ", ..." : ""));
  std::size_t number = 0;
  std::map<std::string, int> names;
  std::vector<double> values;
  for (auto& [key, group] : groups) {
    group.topic.name = key.first.empty() ? "data" : key.first;
    for (int k = names[group.topic.name]++; k > 0; --k) group.topic.name += "'";
    group.topic.type = "arrays of " + std::to_string(key.second) + " rows";
    const bool wanted = sink.topic(number, group.topic);
    const TimeUnit unit = unit_of(*group.time);
    for (std::size_t row = 0; row < key.second; ++row) {
      values.clear();
      for (const Column& column : group.columns) {
        if (wanted) values.push_back(column.array->values[column.first + row * column.step]);
      }
      const double time = (group.time->values[row] - unit.offset) * unit.to_us;
      sink.message(number, {std::abs(time) < 9e15 ? static_cast<std::int64_t>(std::llround(time)) : kNoTime, kNoTime},
                   values);
    }
    ++number;
  }
}

}  // namespace fathom::recordings::arrays
