#include "common/tables/unit_words.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <utility>

#include "common/base/error.hpp"
#include "common/base/units.hpp"

namespace fathom::tables {
namespace {

using Word = std::pair<std::string_view, std::string_view>;

constexpr std::array<Word, 48> kOtherwise{
    {{"sec", "s"},        {"secs", "s"},        {"seconds", "s"},     {"µs", "us"},        {"degrees", "deg"},
     {"degree", "deg"},   {"°", "deg"},         {"°/s", "deg/s"},     {"radians", "rad"},  {"meters", "m"},
     {"metres", "m"},     {"m/s2", "m/s^2"},    {"m/s²", "m/s^2"},    {"m s-1", "m/s"},    {"m.s-1", "m/s"},
     {"m/sec", "m/s"},    {"rad/sec", "rad/s"}, {"deg/sec", "deg/s"}, {"knots", "kn"},     {"kts", "kn"},
     {"volts", "V"},      {"N·m", "N m"},       {"degC", "C"},        {"deg_C", "C"},      {"rad s-1", "rad/s"},
     {"kt", "kn"},        {"dps", "deg/s"},     {"degps", "deg/s"},   {"degs/s", "deg/s"}, {"deg s-1", "deg/s"},
     {"radps", "rad/s"},  {"rads/s", "rad/s"},  {"mps", "m/s"},       {"cmps", "cm/s"},    {"mmps", "mm/s"},
     {"mps2", "m/s^2"},   {"mpss", "m/s^2"},    {"m/s/s", "m/s^2"},   {"m s-2", "m/s^2"},  {"m.s-2", "m/s^2"},
     {"m/sec2", "m/s^2"}, {"m/sec^2", "m/s^2"}, {"kmh", "km/h"},      {"kph", "km/h"},     {"newton", "N"},
     {"newtons", "N"},    {"RPM", "rpm"},       {"r/min", "rpm"}}};

/// At the end of a name, where case says nothing and "in", "min", "s", "g" are more often something else.
constexpr std::array<Word, 32> kEndings{
    {{"deg", "deg"},     {"degrees", "deg"}, {"rad", "rad"}, {"radians", "rad"}, {"mrad", "mrad"}, {"dps", "deg/s"},
     {"degps", "deg/s"}, {"radps", "rad/s"}, {"rpm", "rpm"}, {"rps", "rps"},     {"mps", "m/s"},   {"cmps", "cm/s"},
     {"mmps", "mm/s"},   {"mps2", "m/s^2"},  {"kn", "kn"},   {"kt", "kn"},       {"kts", "kn"},    {"knots", "kn"},
     {"kmh", "km/h"},    {"kph", "km/h"},    {"m", "m"},     {"cm", "cm"},       {"mm", "mm"},     {"ft", "ft"},
     {"n", "N"},         {"nm", "N m"},      {"v", "V"},     {"mv", "mV"},       {"volts", "V"},   {"mbar", "mbar"},
     {"us", "us"},       {"cc", "cc"}}};

/// "deg" and "s" of "yaw_rate_deg_s": above and below the stroke.
constexpr std::array<Word, 9> kAbove{{{"deg", "deg"},
                                      {"degrees", "deg"},
                                      {"rad", "rad"},
                                      {"m", "m"},
                                      {"cm", "cm"},
                                      {"mm", "mm"},
                                      {"km", "km"},
                                      {"rev", "rev"},
                                      {"mrad", "mrad"}}};
constexpr std::array<Word, 6> kBelow{
    {{"s", "s"}, {"sec", "s"}, {"s2", "s^2"}, {"ss", "s^2"}, {"min", "min"}, {"h", "h"}}};

template <std::size_t N>
std::string_view among(const std::array<Word, N>& words, std::string_view text) {
  for (const auto& [theirs, ours] : words) {
    if (text == theirs) return ours;
  }
  return {};
}

bool parts(char c) { return c == '_' || c == ' ' || c == '.' || c == '-' || c == '/'; }

/// Takes the last word, lower case, off a name; `humps`: "yawRateDeg" has three.
std::string take_last(std::string_view& name, bool humps) {
  while (!name.empty() && parts(name.back())) name.remove_suffix(1);
  std::size_t at = name.size();
  while (at > 0 && !parts(name[at - 1])) {
    const bool lower = std::islower(static_cast<unsigned char>(name[at - 1])) != 0;
    if (humps && at < name.size() && lower && std::isupper(static_cast<unsigned char>(name[at])) != 0) break;
    --at;
  }
  std::string word{name.substr(at)};
  std::ranges::transform(word, word.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  name.remove_suffix(name.size() - at);
  while (!name.empty() && parts(name.back())) name.remove_suffix(1);
  return word;
}

NameWithUnit part_at_end(std::string_view name, bool humps) {
  std::string_view rest = name;
  const std::string last = take_last(rest, humps);
  if (const std::string_view below = among(kBelow, last); !below.empty() && !rest.empty()) {
    std::string_view before = rest;
    std::string word = take_last(before, humps);
    if (word == "per") word = take_last(before, humps);
    if (const std::string_view above = among(kAbove, word); !above.empty() && !before.empty())
      return {std::string{before}, std::string{above} + "/" + std::string{below}};
  }
  const std::string_view unit = among(kEndings, last);
  if (!rest.empty()) return {std::string{unit.empty() ? name : rest}, std::string{unit}};
  const bool shaft = unit == "rpm" || unit == "rps";  // the name itself: of a shaft's speed, not of a length
  return {std::string{name}, shaft ? std::string{unit} : ""};
}

}  // namespace

std::string known_unit(std::string_view text) {
  if (const std::string_view ours = among(kOtherwise, text); !ours.empty()) return std::string{ours};
  const auto letter = [](char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'); };
  if (std::ranges::none_of(text, letter)) return {};  // "f(1)"
  for (const char* dimension : {"s", "m", "rad", "m/s", "rad/s", "m/s^2", "N", "N m", "V", "A", "Pa", "C", "W", "Hz"}) {
    try {
      static_cast<void>(unit_factor(text, dimension));
      return std::string(text);
    } catch (const InputError&) {  // another dimension, or no unit
    }
  }
  return {};
}

NameWithUnit unit_at_end(std::string_view name) {
  NameWithUnit parted = part_at_end(name, false);  // "voltage_mV" ends with no V
  return parted.unit.empty() ? part_at_end(name, true) : parted;
}

}  // namespace fathom::tables
