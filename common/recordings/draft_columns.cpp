#include "common/recordings/draft_columns.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <limits>
#include <numbers>
#include <string_view>
#include <utility>

#include "common/base/units.hpp"
#include "common/tables/map_writer.hpp"

namespace fathom::recordings {

using tables::CsvTable;

namespace {

/// "surge_cm_s": a name that ends with its unit. Longer ones first.
constexpr std::array<std::pair<std::string_view, const char*>, 16> kEndings{{{"_deg_s", "deg/s"},
                                                                             {"_rad_s", "rad/s"},
                                                                             {"_m_s2", "m/s^2"},
                                                                             {"_mm_s", "mm/s"},
                                                                             {"_cm_s", "cm/s"},
                                                                             {"_deg", "deg"},
                                                                             {"_rad", "rad"},
                                                                             {"_m_s", "m/s"},
                                                                             {"_nm", "N m"},
                                                                             {"_mm", "mm"},
                                                                             {"_cm", "cm"},
                                                                             {"_kn", "kn"},
                                                                             {"_mv", "mV"},
                                                                             {"_n", "N"},
                                                                             {"_m", "m"},
                                                                             {"_v", "V"}}};

}  // namespace

std::string lower_case(std::string text) {
  std::ranges::transform(text, text.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return text;
}

Columns::Columns(const CsvTable& table) : table_{table} {
  for (std::size_t i = 0; i < table.names.size(); ++i) {
    Column column{.name = &table.names[i],
                  .bare = lower_case(table.names[i]),
                  .unit = table.units[i],
                  .least = std::numeric_limits<double>::infinity(),
                  .greatest = -std::numeric_limits<double>::infinity()};
    for (const double value : table.columns[i]) {
      if (!std::isfinite(value)) continue;
      ++column.count;
      column.least = std::min(column.least, value);
      column.greatest = std::max(column.greatest, value);
    }
    for (const auto& [ending, unit] : kEndings) {
      if (!column.bare.ends_with(ending) || column.bare.size() == ending.size()) continue;
      column.bare.resize(column.bare.size() - ending.size());
      if (column.unit.empty()) column.unit = unit;
      break;
    }
    all_.push_back(column);
  }
}

const Column* Columns::find(const Choices& choices) const {
  for (const std::string_view choice : choices) {
    for (std::size_t i = 0; i < all_.size(); ++i) {
      const std::string name = lower_case(*all_[i].name);
      const bool fits = choice.front() == '.' ? name.ends_with(choice) || name == choice.substr(1)
                                              : name == choice || all_[i].bare == choice;
      if (fits && all_[i].count > 0 && table_.faults[i].empty() && table_.cells_of(i) == tables::Cells::kNumbers)
        return &all_[i];
    }
  }
  return nullptr;
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
  return group.unit("rad/s", group.largest() > kFastest ? "deg/s" : "rad/s");
}

}  // namespace fathom::recordings
