// What a map says of wind, and of columns that are carried as they are.
#include <algorithm>
#include <array>

#include "common/base/error.hpp"
#include "common/base/units.hpp"
#include "common/tables/map_keys.hpp"
#include "common/tables/map_sections.hpp"

namespace fathom::tables::map_sections {

using namespace map_keys;  // NOLINT(google-build-using-namespace)

namespace {

// In which a value is carried.
constexpr std::array kSi{"m",   "m/s",   "m/s^2", "rad", "rad/s", "rad/s^2", "s", "Hz", "kg", "kg/m^3", "m^3",
                         "m^2", "m^3/s", "N",     "N m", "Pa",    "V",       "A", "W",  "K",  "C",      ""};

// What a signal may be said to be, and its unit: what fathom regress looks for. Wind has a section of its own.
constexpr std::array<std::array<const char*, 2>, 4> kQuantities{{{"water_velocity_north", "m/s"},
                                                                 {"water_velocity_east", "m/s"},
                                                                 {"water_velocity_down", "m/s"},
                                                                 {"tether_paid_out", "m"}}};

/// The unit is left as it is where nothing is known of it: counts, salinity.
SignalColumn signal_of(Column column, const std::string& unit, std::string quantity) {
  SignalColumn signal{
      .group = {{std::move(column)}, 1.0}, .written = unit, .unit = unit, .quantity = std::move(quantity)};
  for (const char* si : kSi) {
    try {
      signal.group.factor = unit_factor(unit, si);
      signal.unit = si;
      return signal;
    } catch (const InputError&) {  // of another kind
    }
  }
  return signal;
}

SignalColumn part_of_wind(const Config& config, const std::string& key, const std::string& si, std::string quantity) {
  const Config section = config.section(key);
  ColumnGroup group = scalar(section, si);
  return {.group = std::move(group), .written = section.text("unit"), .unit = si, .quantity = std::move(quantity)};
}

void add_quantities(const Config& config, SignalColumns& signals) {
  const std::vector<std::string> words = config.texts("quantities");
  if (words.size() != signals.columns.size())
    config.fail("quantities", "'quantities' needs one word for each of 'columns', none where there is none");
  for (std::size_t i = 0; i < words.size(); ++i) {
    if (words[i] == "none") continue;
    const auto known = std::ranges::find_if(kQuantities, [&](const auto& one) { return words[i] == one[0]; });
    if (known == kQuantities.end())
      config.fail("quantities", "'" + words[i] +
                                    "' is no quantity: water_velocity_north, water_velocity_east, water_velocity_down, "
                                    "tether_paid_out, none");
    SignalColumn& signal = signals.columns[i];
    if (signal.unit != (*known)[1])
      config.fail("quantities", "a " + words[i] + " is told in " + (*known)[1] +
                                    " or what can be turned into it, not in '" + signal.written + "'");
    signal.quantity = words[i];
  }
}

}  // namespace

SignalColumns wind_of(const Config& config) {
  const std::string reference = config.text("reference");
  if (reference != "true" && reference != "apparent")
    config.fail("reference",
                "'reference' must be true (over ground, direction from north) or apparent (as felt on board, direction "
                "from the bow)");
  SignalColumns wind;
  if (config.has("speed")) wind.columns.push_back(part_of_wind(config, "speed", "m/s", "wind_speed_" + reference));
  if (config.has("from")) wind.columns.push_back(part_of_wind(config, "from", "rad", "wind_from_" + reference));
  if (wind.columns.empty())
    config.fail("", "'wind' needs speed, from (the direction from which it blows, clockwise) or both");
  wind.invalid_where = invalid_of(config);
  return wind;
}

SignalColumns signals_of(const Config& config) {
  const std::vector<Column> columns = columns_of(config, "columns");
  const std::vector<std::string> units = config.texts("units");
  if (units.size() != columns.size())
    config.fail("units", "'units' needs one unit for each of 'columns', [m/s, deg, 1] for example");
  SignalColumns signals;
  for (std::size_t i = 0; i < columns.size(); ++i) signals.columns.push_back(signal_of(columns[i], units[i], ""));
  if (config.has("quantities")) add_quantities(config, signals);
  signals.invalid_where = invalid_of(config);
  return signals;
}

}  // namespace fathom::tables::map_sections
