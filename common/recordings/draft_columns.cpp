#include "common/recordings/draft_columns.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <limits>
#include <numbers>

#include "common/base/units.hpp"
#include "common/recordings/column_words.hpp"
#include "common/tables/map_writer.hpp"
#include "common/tables/unit_words.hpp"

namespace fathom::recordings {

using tables::CsvTable;

std::string lower_case(std::string text) {
  std::ranges::transform(text, text.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return text;
}

Columns::Columns(const CsvTable& table) : table_{table} {
  for (std::size_t i = 0; i < table.names.size(); ++i) {
    Column column{.name = &table.names[i],
                  .bare = {},
                  .words = {},
                  .unit = table.units[i],
                  .least = std::numeric_limits<double>::infinity(),
                  .greatest = -std::numeric_limits<double>::infinity()};
    for (const double value : table.columns[i]) {
      if (!std::isfinite(value)) continue;
      ++column.count;
      column.least = std::min(column.least, value);
      column.greatest = std::max(column.greatest, value);
    }
    const tables::NameWithUnit parted = tables::unit_at_end(table.names[i]);
    column.bare = lower_case(parted.name);
    column.words = words_of(parted.name);
    if (column.unit.empty()) column.unit = parted.unit;
    for (const char* shaft : {"rpm", "rps"}) {  // "rpm_port" says it at its beginning
      if (column.unit.empty() && std::ranges::find(column.words, shaft) != column.words.end()) column.unit = shaft;
    }
    all_.push_back(column);
  }
}

const Column* Columns::find(const Choices& choices) const {
  const auto first = [&](const auto& fits) -> const Column* {
    for (const std::string& choice : choices) {
      for (std::size_t i = 0; i < all_.size(); ++i) {
        if (holds_numbers(i) && fits(all_[i], choice)) return &all_[i];
      }
    }
    return nullptr;
  };
  const Column* exactly = first([](const Column& one, const std::string& choice) {
    const std::string name = lower_case(*one.name);
    if (choice.front() == '.') return name.ends_with(choice) || name == choice.substr(1);
    return name == choice || one.bare == choice;
  });
  if (exactly != nullptr) return exactly;
  return first([](const Column& one, const std::string& choice) {
    return choice.front() != '.' && one.words == words_of(choice);
  });
}

bool Columns::holds_numbers(std::size_t i) const {
  return all_[i].count > 0 && table_.faults[i].empty() && table_.cells_of(i) == tables::Cells::kNumbers;
}

Group::Group(const Columns& all, const std::vector<Choices>& components) {
  for (const Choices& choices : components) columns.push_back(all.find(choices));
}

std::size_t Group::there() const {
  return static_cast<std::size_t>(std::ranges::count_if(columns, [](const Column* one) { return one != nullptr; }));
}

std::string Group::list() const {
  std::string text = "[";
  for (const Column* one : columns)
    text += (text.size() > 1 ? ", " : "") + (one == nullptr ? "none" : tables::written_name(*one->name));
  return text + "]";
}

double Group::largest() const {
  double largest = 0.0;
  for (const Column* one : columns) {
    if (one != nullptr) largest = std::max({largest, std::abs(one->least), std::abs(one->greatest)});
  }
  return largest;
}

std::string Group::unit(const char* dimension, const std::string& otherwise) const {
  for (const Column* one : columns) {
    if (one == nullptr || one->unit.empty()) continue;
    try {
      static_cast<void>(unit_factor(one->unit, dimension));
      return one->unit;
    } catch (const std::exception&) {  // of another kind
    }
  }
  return otherwise;
}

std::string vector_line(const char* key, const Group& group, const std::string& unit, const char* frame) {
  return std::string{"  "} + key + ": {columns: " + group.list() + ", unit: " + unit + ", frame: " + frame + "}\n";
}

std::string angle_unit(const Group& group) {
  return group.unit("rad", group.largest() > 2.0 * std::numbers::pi ? "deg" : "rad");
}
std::string rate_unit(const Group& group) {
  constexpr double kFastest = 6.0;  // rad/s
  const std::string unit = group.unit("rad/s", group.largest() > kFastest ? "deg/s" : "rad/s");
  return unit == "rps" ? "rad/s" : unit;  // of a craft, not of a shaft
}

}  // namespace fathom::recordings
