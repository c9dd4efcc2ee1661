#include "common/recordings/collector.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include "common/base/time.hpp"

namespace fathom::recordings {
namespace {

constexpr std::size_t kMostSteps = 4096;  // enough for a median

/// Where "[3]" begins at the end of a name; npos where it does not.
std::size_t instance_at(const std::string& topic) {
  const std::size_t open = topic.rfind('[');
  if (open == std::string::npos || open == 0 || !topic.ends_with(']') || open + 2 == topic.size())
    return std::string::npos;
  const bool digits = std::all_of(topic.begin() + static_cast<std::ptrdiff_t>(open) + 1, topic.end() - 1,
                                  [](char c) { return c >= '0' && c <= '9'; });
  return digits && topic.size() - open < 8 ? open : std::string::npos;
}

}  // namespace

std::vector<std::string> names_of_topic(const std::string& topic) {
  const std::size_t at = instance_at(topic);
  return {topic, at == std::string::npos ? topic + "[0]" : topic.substr(0, at)};
}

int instance_of(const std::string& topic) {
  const std::size_t at = instance_at(topic);
  return at == std::string::npos ? 0 : std::stoi(topic.substr(at + 1));
}

double TopicAccount::rate() const {
  std::vector<std::int64_t> sorted;
  std::ranges::copy_if(steps, std::back_inserter(sorted), [](std::int64_t step) { return step > 0; });
  if (sorted.empty()) return 0.0;
  const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2);
  std::nth_element(sorted.begin(), middle, sorted.end());
  return 1e6 / static_cast<double>(*middle);
}

Collector::Collector(ClockRules clock, std::set<std::string> columns, Take accounts)
    : wanted_(std::move(columns)),
      take_(accounts),
      guard_(
          clock, [this](const Judged& judged, std::size_t recording) { keep(judged, recording); },
          [this](const Judged& judged) { ++topics_[judged.topic].refused; }) {}

void Collector::ask(std::size_t topic, std::size_t field) {
  for (const std::string& own : names_of_topic(topics_[topic].topic.name)) {
    const std::string name = own + "." + topics_[topic].topic.fields[field].name;
    if (!wanted_.contains(name)) continue;
    TopicRows& rows = rows_[topic];
    slots_[topic].push_back({field, rows.columns.size()});
    rows.names.push_back(name);
    rows.columns.emplace_back();
    for (std::size_t i = 0; i < rows.stamps.size(); ++i) rows.columns.back().push_back(std::nan(""));
  }
}

bool Collector::topic(std::size_t number, const Topic& topic) {
  topics_.resize(std::max(topics_.size(), number + 1));
  rows_.resize(topics_.size());
  slots_.resize(topics_.size());
  topics_[number].topic = topic;
  topics_[number].fields.resize(topic.fields.size());
  for (std::size_t i = 0; i < topic.fields.size(); ++i) ask(number, i);
  if (take_ == Take::kEverything || !slots_[number].empty()) return true;
  // A list that has not come yet may hold what is asked for.
  return std::ranges::any_of(names_of_topic(topic.name), [&](const std::string& own) {
    const auto after = wanted_.lower_bound(own + ".");
    return after != wanted_.end() && after->starts_with(own + ".");
  });
}

void Collector::further_field(std::size_t topic, const Field& field) {
  topics_[topic].topic.fields.push_back(field);
  topics_[topic].fields.emplace_back();
  ask(topic, topics_[topic].topic.fields.size() - 1);
}

void Collector::message(std::size_t topic, Stamp stamp, std::span<const double> values) {
  if (stamp.log == kNoTime) {
    ++topics_[topic].untimed;
    return;
  }
  if (!is_time(stamp.measured)) stamp.measured = kNoTime;
  guard_.push(topic, stamp, values);
}

void Collector::text(std::size_t topic, std::string_view field, std::string_view words) {
  if (topics_[topic].words.empty() && !words.empty())
    topics_[topic].words = std::string{field} + ": " + std::string{words};
}

void Collector::keep(const Judged& judged, std::size_t recording) {
  TopicAccount& account = topics_[judged.topic];
  const std::int64_t time = judged.stamp.log;
  ++account.messages;
  if (recording >= recordings_) {
    recordings_ = static_cast<std::uint32_t>(recording) + 1;
    for (TopicAccount& each : topics_) each.latest = kNoTime;  // no gap between two recordings
  }
  account.first = account.first == kNoTime ? time : std::min(account.first, time);
  account.last = account.last == kNoTime ? time : std::max(account.last, time);
  if (account.latest != kNoTime) {
    const std::int64_t step = time - account.latest;
    account.longest_gap = std::max(account.longest_gap, step);
    if (account.steps.size() < kMostSteps) account.steps.push_back(step);
  }
  account.latest = time;
  if (judged.stamp.measured != kNoTime && account.delays.size() < kMostSteps)
    account.delays.push_back(time - judged.stamp.measured);
  if (take_ == Take::kEverything) {
    for (std::size_t i = 0; i < judged.values.size() && i < account.fields.size(); ++i) {
      const double value = judged.values[i];
      if (!std::isfinite(value)) continue;
      FieldAccount& field = account.fields[i];
      if (field.finite++ == 0) {
        field.least = field.greatest = field.first = value;
      } else {
        field.least = std::min(field.least, value);
        field.greatest = std::max(field.greatest, value);
        field.changes += value != field.latest ? 1 : 0;
      }
      field.latest = value;
    }
  }
  if (slots_[judged.topic].empty()) return;
  TopicRows& rows = rows_[judged.topic];
  rows.stamps.push_back(judged.stamp);
  rows.recording.push_back(static_cast<std::uint32_t>(recording));
  for (const Slot& slot : slots_[judged.topic])  // one for each column, in their order
    rows.columns[slot.column].push_back(slot.field < judged.values.size() ? judged.values[slot.field] : std::nan(""));
}

std::uint64_t Collector::messages() const {
  std::uint64_t sum = 0;
  for (const TopicAccount& each : topics_) sum += each.messages;
  return sum;
}

std::uint64_t Collector::refused() const {
  std::uint64_t sum = 0;
  for (const TopicAccount& each : topics_) sum += each.refused;
  return sum;
}

}  // namespace fathom::recordings
