#include "common/report/finding.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

#include "common/model/effect.hpp"
#include "common/report/text.hpp"

namespace fathom::report {
namespace {

/// "11 %", "0.35 s": the two ends share the unit.
std::string between(double value, double low, double high, double scale, const std::string& unit) {
  std::string text = number(scale * value, 3);
  if (std::isfinite(low) && std::isfinite(high) && high > low)
    text += " (" + number(scale * low, 3) + " to " + number(scale * high, 3) + ")";
  return text + (unit.empty() ? "" : " " + unit);
}

/// A share that is more or less than one: "29 % (27.5 to 30.5) less".
std::string more_or_less(const NamedValue& value) {
  const auto [low, high] = value.range95();
  const bool less = value.value < 0.0;
  return less ? between(-value.value, -high, -low, 100.0, "%") + " less"
              : between(value.value, low, high, 100.0, "%") + " more";
}

std::string early_or_late(const NamedValue& value) {
  const auto [low, high] = value.range95();
  return value.value < 0.0 ? "early by " + between(-value.value, -high, -low, 1.0, value.unit)
                           : "late by " + plain_value(value);
}

std::string share(const NamedValue& value) {
  const auto [low, high] = value.range95();
  return between(value.value, low, high, 100.0, "%");
}

/// "FL" becomes "thruster FL"; "thruster 3" stays.
std::string thruster(const std::string& place) {
  if (place == "all") return "each thruster";
  return place.starts_with("thruster ") ? place : "thruster " + place;
}

/// Numbers of one place, named as the effect names them.
struct At {
  std::string place;
  std::vector<NamedValue> values;
};

std::vector<At> by_place(const EffectFound& effect) {
  std::vector<At> all;
  for (NamedValue value : effect.parameters) {
    const std::size_t dot = value.name.rfind('.');
    const std::string place = dot == std::string::npos ? effect.variant : value.name.substr(0, dot);
    if (dot != std::string::npos) value.name.erase(0, dot + 1);
    auto at = std::ranges::find(all, place, &At::place);
    if (at == all.end()) at = all.insert(all.end(), {place, {}});
    at->values.push_back(std::move(value));
  }
  return all;
}

/// `asked`: "form", "thruster", or a number and how it is to be told: "gain_change more". Nothing: there is none.
std::optional<std::string> told(std::string_view asked, const At& at) {
  if (asked == "form") return at.place;
  if (asked == "thruster") return thruster(at.place);
  const std::string_view name = asked.substr(0, asked.find(' '));
  const auto found = std::ranges::find(at.values, name, &NamedValue::name);
  if (found == at.values.end()) return std::nullopt;
  const std::string_view how = name.size() == asked.size() ? std::string_view{} : asked.substr(name.size() + 1);
  if (how == "more") return more_or_less(*found);
  if (how == "late") return early_or_late(*found);
  if (how == "%") return share(*found);
  return plain_value(*found);
}

std::optional<std::string> filled(std::string_view sentence, const At& at) {
  std::string text;
  while (!sentence.empty()) {
    const std::size_t open = sentence.find('{'), close = sentence.find('}', open);
    text += sentence.substr(0, open);
    if (close == std::string_view::npos) break;
    const auto words = told(sentence.substr(open + 1, close - open - 1), at);
    if (!words) return std::nullopt;
    text += *words;
    sentence.remove_prefix(close + 1);
  }
  return text;
}

}  // namespace

std::string plain_value(const NamedValue& value) {
  const auto [low, high] = value.range95();
  return between(value.value, low, high, 1.0, value.unit);
}

std::string finding(const EffectFound& effect) {
  const model::Effect* known = model::find_effect(effect.name);
  if (known == nullptr || known->traits().finding.empty()) return "";
  std::string all;
  for (const At& at : by_place(effect)) {
    const auto words = filled(known->traits().finding, at);
    if (!words) return "";
    all += (all.empty() ? "" : ", ") + *words;
  }
  if (all.starts_with("thruster") || all.starts_with("each"))
    all[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(all[0])));
  return all;
}

}  // namespace fathom::report
