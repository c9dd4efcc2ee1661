#include "common/vision/tag_sizes.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>

#include "common/base/error.hpp"
#include "common/base/units.hpp"
#include "common/vision/tag_detector.hpp"

namespace fathom::vision {
namespace {

template <class Number>
std::optional<Number> leading(std::string_view& text) {
  Number value{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{}) return {};
  text.remove_prefix(static_cast<std::size_t>(end - text.data()));
  return value;
}

[[noreturn]] void refuse(const std::string& word, const std::string& why) {
  throw InputError("--size " + word + ": " + why);
}

double length(const std::string& word, std::string_view text) {
  const auto number = leading<double>(text);
  if (!number)
    refuse(word, "state a length in metres, for all tags, a family or one tag: 0.15, 16h5=0.15, 16h5:3=12cm");
  while (text.starts_with(' ')) text.remove_prefix(1);
  double size = *number;
  try {
    if (!text.empty()) size *= unit_factor(text, "m");
  } catch (const InputError& error) {
    refuse(word, error.what());
  }
  if (!(size > 0.0) || !std::isfinite(size)) refuse(word, "a tag's edge is longer than nothing");
  return size;
}

}  // namespace

TagSizes TagSizes::parse(const std::vector<std::string>& words) {
  TagSizes sizes;
  for (const std::string& word : words) {
    const auto equals = word.find('=');
    Rule rule{.size = length(word, std::string_view{word}.substr(equals == std::string::npos ? 0 : equals + 1))};
    if (equals != std::string::npos) {
      const auto colon = std::min(word.find(':'), equals);
      rule.family = word.substr(0, colon);
      const int count = tags_of(rule.family);
      if (colon < equals) {
        std::string_view digits = std::string_view{word}.substr(colon + 1, equals - colon - 1);
        rule.id = leading<int>(digits);
        if (!rule.id || !digits.empty() || *rule.id < 0 || *rule.id >= count) {
          refuse(word, rule.family + " has the tags 0 to " + std::to_string(count - 1));
        }
      }
    }
    const bool twice = std::any_of(sizes.rules_.begin(), sizes.rules_.end(), [&](const Rule& each) {
      return each.id == rule.id && each.family.empty() == rule.family.empty() &&
             model::same_family(each.family, rule.family);
    });
    if (twice) refuse(word, "the size of these tags is stated twice");
    sizes.add(rule);
  }
  return sizes;
}

std::optional<double> TagSizes::of(const model::TagName& name) const {
  const auto particular = [](const Rule& rule) { return rule.id ? 2 : (rule.family.empty() ? 0 : 1); };
  const Rule* best = nullptr;
  for (const Rule& each : rules_) {
    if (!each.family.empty() && !model::same_family(each.family, name.family)) continue;
    if (each.id && *each.id != name.id) continue;
    if (best == nullptr || particular(each) > particular(*best)) best = &each;
  }
  if (best == nullptr) return {};
  return best->size;
}

double TagSizes::largest() const {
  double size = 0.0;
  for (const Rule& each : rules_) size = std::max(size, each.size);
  return size;
}

void TagSizes::check_against(const model::Site& site) const {
  for (const Rule& each : rules_) {
    if (each.family.empty()) continue;
    const bool wanted = std::any_of(site.search.families.begin(), site.search.families.end(),
                                    [&](const std::string& family) { return model::same_family(family, each.family); });
    if (!wanted)
      refuse(each.family, "this family is not looked for; --families, or 'tag_search' of the site, names it");
    const model::Tag* known = each.id ? site.tag(each.family, *each.id) : nullptr;
    if (known != nullptr) {
      refuse(each.family + ":" + std::to_string(*each.id),
             "this tag is in the site's map with its size, " + std::to_string(known->size) + " m");
    }
  }
}

}  // namespace fathom::vision
