#include "common/tables/header_units.hpp"

#include <array>
#include <cctype>
#include <string_view>
#include <utility>

#include "common/base/error.hpp"
#include "common/base/units.hpp"

namespace fathom::tables {
namespace {

constexpr std::array<std::pair<std::string_view, const char*>, 25> kUnits{
    {{"t", "s"},       {"x", "m"},     {"y", "m"},     {"z", "m"},       {"phi", "rad"},
     {"theta", "rad"}, {"psi", "rad"}, {"u", "m/s"},   {"v", "m/s"},     {"w", "m/s"},
     {"p", "rad/s"},   {"q", "rad/s"}, {"r", "rad/s"}, {"ax", "m/s^2"},  {"ay", "m/s^2"},
     {"az", "m/s^2"},  {"X", "N"},     {"Y", "N"},     {"Z", "N"},       {"K", "N m"},
     {"M", "N m"},     {"N", "N m"},   {"depth", "m"}, {"voltage", "V"}, {"altitude", "m"}}};

/// SI unit of a canonical column; nullptr for others.
const char* unit_of(std::string_view name) {
  for (const auto& [known, unit] : kUnits) {
    if (name == known) return unit;
  }
  const auto numbered = [&](std::string_view prefix) {
    return name.starts_with(prefix) && name.size() > prefix.size() &&
           std::isdigit(static_cast<unsigned char>(name[prefix.size()])) != 0;
  };
  if (name.starts_with("range_")) return "m";
  if (name.starts_with("load_")) return "N";
  return numbered("f") ? "N" : numbered("pwm") ? "us" : nullptr;
}

}  // namespace

std::vector<std::string> to_si(CsvTable& table) {
  std::vector<std::string> notes;
  for (std::size_t i = 0; i < table.names.size(); ++i) {
    const std::string& name = table.names[i];
    const auto open = name.find_first_of("[(");
    if (table.units[i].empty() && open != std::string::npos && open > 0 && (name.back() == ']' || name.back() == ')')) {
      std::string bare = name.substr(0, open);
      while (!bare.empty() && bare.back() == ' ') bare.pop_back();
      if (unit_of(bare) != nullptr)
        throw InputError(table.path + ":1: column '" + name + "': its unit is not known; '" + bare + "' is in " +
                         unit_of(bare) + " where none is stated");
    }
    const char* ours = unit_of(name);
    if (ours == nullptr || table.units[i].empty() || table.units[i] == ours) continue;
    double factor = 1.0;
    try {
      factor = unit_factor(table.units[i], ours);
    } catch (const InputError&) {
      throw InputError(table.path + ":1: column '" + name + "' is in " + table.units[i] + ", where " + ours +
                       " is meant; describe what it is with a map (--map)");
    }
    table.columns[i].change([factor](double& value) { value *= factor; });
    notes.push_back("column '" + name + "' is in " + table.units[i] + ", as its header says");
  }
  return notes;
}

}  // namespace fathom::tables
