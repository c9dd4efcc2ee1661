// Words and numbers of the report; see text.hpp.
#include "common/report/text.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>

namespace fathom::report {
namespace {

constexpr double kLopsided = 1.25;  // one side of an interval over the other: written as a range
constexpr double kDegrees = 180.0 / std::numbers::pi;

std::string printed(const char* format, int digits, double value) {
  std::array<char, 64> buffer{};
  std::snprintf(buffer.data(), buffer.size(), format, digits, value);
  return buffer.data();
}

bool starts_character(char c) { return (static_cast<unsigned char>(c) & 0xC0U) != 0x80U; }

// The first `count` characters of UTF-8 text.
std::string_view head(std::string_view text, std::size_t count) {
  std::size_t seen = 0;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (starts_character(text[i]) && seen++ == count) return text.substr(0, i);
  }
  return text;
}

std::string fitted(std::string_view text, std::size_t width) {
  if (columns(text) <= width) return std::string(text);
  return std::string(head(text, width - 1)) + "…";
}

bool finite_anywhere(const ModelError& error, std::size_t axis) {
  return std::ranges::any_of(error.prediction, [&](const auto& p) { return std::isfinite(p.rmse[axis]); });
}

}  // namespace

const std::array<Axis, 6> kAxes{{{"surge", "u", "m/s", 1.0, "X", "N"},
                                 {"sway", "v", "m/s", 1.0, "Y", "N"},
                                 {"heave", "w", "m/s", 1.0, "Z", "N"},
                                 {"roll", "p", "deg/s", kDegrees, "K", "N m"},
                                 {"pitch", "q", "deg/s", kDegrees, "M", "N m"},
                                 {"yaw", "r", "deg/s", kDegrees, "N", "N m"}}};

std::string velocity_label(const Axis& axis) {
  return std::string(axis.name) + " " + axis.velocity + " [" + axis.unit + "]";
}

std::string force_label(const Axis& axis) {
  const bool turning = std::string_view(axis.force_unit) == "N m";
  return std::string(axis.name) + (turning ? " moment " : " force ") + axis.force + " [" + axis.force_unit + "]";
}

std::string number(double value, int digits) {
  if (!std::isfinite(value)) return "-";
  if (value == 0.0) return "0";
  const double size = std::abs(value);
  if (size >= 1e6 || size < 1e-4) return printed("%.*e", digits - 1, value);
  const int whole = static_cast<int>(std::floor(std::log10(size)));
  return printed("%.*f", std::max(0, digits - 1 - whole), value);
}

std::string plain(double value) { return printed("%.*g", 4, value); }

std::string r_squared(double value) {
  if (!std::isfinite(value)) return "-";
  if (value < -99.0) return "<-99";
  return printed("%.*f", value <= -9.995 ? 1 : 2, value);
}

std::string percent(double share) {
  if (!std::isfinite(share)) return "-";
  const double value = 100.0 * share + 0.0;  // no sign before nothing
  const bool small = value != 0.0 && std::abs(value) < 0.95;
  return printed("%.*f", small ? 1 : 0, value) + " %";
}

std::string percent_interval(double low, double high) {
  if (!std::isfinite(low) || !std::isfinite(high)) return "too few windows for an interval";
  return "95 %: " + percent(low) + " to " + percent(high);
}

std::string how_far(const Foretold& foretold) {
  if (foretold.cut == 0) return "";
  return "In " + std::to_string(foretold.cut) + " of " + std::to_string(foretold.windows) +
         " predictions a small change of the start grows fivefold by the models, within " +
         number(foretold.typical, 2) +
         " s mostly: errors count so far only, for nobody can foretell more of such a motion from where it was measured"
         " to begin.";
}

std::string five_seconds_ahead(const Foretold& foretold) {
  const bool sooner = 2 * foretold.cut > foretold.windows && foretold.typical < 5.0;
  return sooner ? "as far as it can be foretold, " + number(foretold.typical, 2) + " s mostly" : "5 s ahead";
}

std::string odds(double log_odds) {
  if (std::isnan(log_odds)) return "-";
  const double decades = std::abs(log_odds) / std::numbers::ln10;
  const std::string factor =
      decades < 6.0 ? printed("%.*f", decades < 1.0 ? 1 : 0, std::exp(std::abs(log_odds)))
                    : (std::isfinite(decades) ? "10^" + printed("%.*f", 0, decades) : std::string("unlimited"));
  return log_odds >= 0.0 ? factor + " : 1" : "1 : " + factor;
}

std::string log_odds_text(double log_odds) { return number(std::abs(log_odds) < 0.01 ? 0.0 : log_odds); }

std::string size_beside_rest(double share, double over) {
  std::string words = percent(share) + " of the applied force";
  if (over > 0.0) words += ", " + number(over, 2) + " times what is left there";
  return words;
}

std::string effect_title(const std::string& name, const std::string& variant) {
  std::string title = name;
  if (!name.starts_with("column ")) std::ranges::replace(title, '_', ' ');
  return variant.empty() ? title : title + " (" + variant + ")";
}

std::string with_interval(const NamedValue& value) {
  std::string text = number(value.value);
  if (std::isfinite(value.std) && value.std > 0.0) {
    const auto [low, high] = value.range95();
    const double below = value.value - low, above = high - value.value;
    const bool lopsided = std::max(below, above) > kLopsided * std::min(below, above);
    text += lopsided ? " (" + number(low, 3) + " to " + number(high, 3) + ")" : " ± " + number(0.5 * (high - low), 2);
  }
  return value.unit.empty() ? text : text + " " + value.unit;
}

std::string join(const std::vector<std::string>& parts, std::string_view separator) {
  std::string text;
  for (const auto& part : parts) {
    if (!text.empty()) text += separator;
    text += part;
  }
  return text;
}

std::string escape(std::string_view text) {
  std::string safe;
  safe.reserve(text.size());
  for (const char c : text) {
    switch (c) {
      case '&':
        safe += "&amp;";
        break;
      case '<':
        safe += "&lt;";
        break;
      case '>':
        safe += "&gt;";
        break;
      case '"':
        safe += "&quot;";
        break;
      case '\'':
        safe += "&#39;";
        break;
      default:
        if (static_cast<unsigned char>(c) >= 0x20U || c == '\n' || c == '\t') safe += c;
    }
  }
  return safe;
}

std::size_t columns(std::string_view text) {
  return static_cast<std::size_t>(std::ranges::count_if(text, starts_character));
}

std::string pad_right(std::string_view text, std::size_t width) {
  const std::string cell = fitted(text, width);
  return cell + std::string(width - columns(cell), ' ');
}

std::string pad_left(std::string_view text, std::size_t width) {
  const std::string cell = fitted(text, width);
  return std::string(width - columns(cell), ' ') + cell;
}

std::vector<std::string> wrap(std::string_view text, std::size_t width) {
  std::vector<std::string> lines;
  std::string line;
  const auto flush = [&] {
    if (!line.empty()) lines.push_back(std::move(line));
    line.clear();
  };
  constexpr std::string_view kSpace = " \t\r\n";
  for (std::size_t begin = text.find_first_not_of(kSpace); begin != std::string_view::npos;) {
    const std::size_t end = std::min(text.find_first_of(kSpace, begin), text.size());
    std::string_view word = text.substr(begin, end - begin);
    if (!line.empty() && columns(line) + 1 + columns(word) > width) flush();
    for (; columns(word) > width; word.remove_prefix(head(word, width).size())) lines.emplace_back(head(word, width));
    line += (line.empty() ? "" : " ") + std::string(word);
    begin = text.find_first_not_of(kSpace, end);
  }
  flush();
  return lines;
}

std::vector<FindingGroup> group_findings(const std::vector<ConsistencyFinding>& findings) {
  std::vector<FindingGroup> groups;
  for (const auto& finding : findings) {
    const auto same = std::ranges::find_if(groups, [&](const FindingGroup& group) {
      const ConsistencyFinding& first = *group.members.front();
      return first.signal == finding.signal && first.reference == finding.reference &&
             first.finding == finding.finding && first.unit == finding.unit && first.action == finding.action;
    });
    if (same == groups.end()) {
      groups.push_back({{&finding}, finding.size, finding.size});
      continue;
    }
    same->smallest = std::fmin(same->smallest, finding.size);
    same->largest = std::fmax(same->largest, finding.size);
    same->members.push_back(&finding);
    if (std::abs(finding.size) > std::abs(same->members.front()->size)) {
      std::swap(same->members.front(), same->members.back());
    }
  }
  return groups;
}

std::string size_text(const FindingGroup& group) {
  const std::string& unit = group.members.front()->unit;
  const std::string low = number(group.smallest);
  const std::string high = number(group.largest);
  return (low == high ? high : low + " to " + high) + (unit.empty() ? "" : " " + unit);
}

bool predicted(const DiagnosisResult& result, std::size_t axis) {
  return finite_anywhere(result.error_before, axis) || finite_anywhere(result.error_after, axis);
}

const EffectFound* accepted_form(const DiagnosisResult& result, const CandidateTried& candidate) {
  const auto found = std::ranges::find_if(result.effects, [&](const EffectFound& effect) {
    return effect.accepted && effect.name == candidate.name && effect.variant == candidate.variant;
  });
  return found == result.effects.end() ? nullptr : &*found;
}

}  // namespace fathom::report
