#include "common/recordings/joined_parts.hpp"

#include <algorithm>
#include <limits>

namespace fathom::recordings {

std::size_t JoinedParts::place(Whole& whole, const Field& field) {
  const auto [at, added] = whole.fields.emplace(field.name, whole.fields.size());
  if (added) whole_.further_field(whole.number, field);
  return at->second;
}

bool JoinedParts::topic(std::size_t number, const Topic& topic) {
  topics_.resize(std::max(topics_.size(), number + 1));
  const std::string key = topic.name + "\n" + topic.type;
  auto found = known_.find(key);
  if (found == known_.end()) {
    found = known_.emplace(key, Whole{.number = known_.size(), .wanted = false, .fields = {}}).first;
    for (const Field& field : topic.fields) found->second.fields.emplace(field.name, found->second.fields.size());
    found->second.wanted = whole_.topic(found->second.number, topic);
  }
  Part& part = topics_[number];
  part.whole = &found->second;
  part.fields.clear();
  for (const Field& field : topic.fields) part.fields.push_back(place(found->second, field));
  return found->second.wanted;
}

void JoinedParts::further_field(std::size_t topic, const Field& field) {
  topics_[topic].fields.push_back(place(*topics_[topic].whole, field));
}

void JoinedParts::message(std::size_t topic, Stamp stamp, std::span<const double> values) {
  const Part& part = topics_[topic];
  values_.clear();
  if (!values.empty()) values_.assign(part.whole->fields.size(), std::numeric_limits<double>::quiet_NaN());
  for (std::size_t i = 0; i < values.size() && i < part.fields.size(); ++i) values_[part.fields[i]] = values[i];
  whole_.message(part.whole->number, stamp, values_);
}

void JoinedParts::text(std::size_t topic, std::string_view field, std::string_view words) {
  whole_.text(topics_[topic].whole->number, field, words);
}

}  // namespace fathom::recordings
