#include "common/recordings/draft.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <filesystem>

#include "common/recordings/usual_topics.hpp"
#include "common/tables/map_writer.hpp"

namespace fathom::recordings {
namespace {

constexpr std::size_t kMostFields = 40;  // named of a topic
constexpr std::size_t kMostWords = 60;   // letters of a topic's text

std::string formatted(const char* format, double value) {
  std::array<char, 48> text{};
  std::snprintf(text.data(), text.size(), format, value);
  return text.data();
}

/// What a file calls something, as part of a line.
std::string one_line(std::string text) {
  std::ranges::replace_if(
      text, [](unsigned char c) { return c < ' '; }, ' ');
  return text;
}

struct Candidate {
  Entry entry;
  std::uint64_t messages{};
};

std::vector<Candidate> candidates(const Content& content) {
  std::vector<Candidate> all;
  for (const TopicAccount& topic : content.topics->topics()) {
    if (topic.messages == 0) continue;
    for (Entry& entry : entries_of(topic)) all.push_back({std::move(entry), topic.messages});
  }
  std::ranges::stable_sort(all, [](const Candidate& a, const Candidate& b) {
    if (a.entry.drafted != b.entry.drafted) return a.entry.drafted;
    if (a.entry.rank != b.entry.rank) return a.entry.rank < b.entry.rank;
    return a.messages > b.messages;
  });
  return all;
}

const char* stream_of(Quantity quantity) {
  switch (quantity) {
    case Quantity::kInertial:
    case Quantity::kAttitude:
      return "ahrs";
    case Quantity::kPose:
      return "pose_capture";
    case Quantity::kVelocity:
      return "dvl";
    case Quantity::kDepth:
      return "depth";
    case Quantity::kThrust:
      return "thrusters";
    default:
      return "battery";
  }
}

void write(std::string& text, const Entry& entry, bool list, const std::string& comment) {
  if (!entry.remark.empty()) text += comment + "  # " + entry.topic + ": " + entry.remark + "\n";
  for (std::size_t i = 0; i < entry.lines.size(); ++i)
    text += comment + (list ? (i == 0 ? "  - " : "    ") : "  ") + entry.lines[i] + "\n";
}

}  // namespace

std::string draft_map(const Content& content) {
  const std::vector<Candidate> all = candidates(content);
  std::string text = "source: " + tables::written_name(std::filesystem::path(content.path()).filename().string()) +
                     "\nlicence: not stated\n";
  bool any = false;
  for (const std::vector<Quantity>& quantities :
       std::vector<std::vector<Quantity>>{{Quantity::kPose},
                                          {Quantity::kInertial, Quantity::kAttitude},
                                          {Quantity::kVelocity},
                                          {Quantity::kDepth},
                                          {Quantity::kThrust},
                                          {Quantity::kBattery}}) {
    std::vector<const Candidate*> chosen, others;
    for (const Quantity quantity : quantities) {
      bool taken = false;
      for (const Candidate& one : all) {
        if (one.entry.quantity != quantity) continue;
        const auto says_attitude = [](const Candidate* other) {
          return std::ranges::any_of(other->entry.lines,
                                     [](const std::string& line) { return line.starts_with("quaternion"); });
        };
        const bool had = quantity == Quantity::kAttitude && std::ranges::any_of(chosen, says_attitude);
        (one.entry.drafted && !taken && !had ? chosen : others).push_back(&one);
        taken = taken || one.entry.drafted;
      }
    }
    if (chosen.empty() && others.empty()) continue;
    const std::string stream = stream_of(quantities.front());
    const bool list = chosen.size() > 1;
    if (!chosen.empty()) text += stream + ":\n";
    for (const Candidate* one : chosen) write(text, one->entry, list, "");
    any = any || !chosen.empty();
    for (const Candidate* one : others) {
      if (chosen.empty()) {
        text += "# " + stream + ":\n";
        write(text, one->entry, false, "# ");
      } else {
        text += "  # could be as well: " + one->entry.topic +
                (one->entry.drafted || one->entry.remark.empty() ? "" : " (" + one->entry.remark + ")") + "\n";
      }
    }
  }
  return any ? text : "";
}

std::string description(const Content& content) {
  std::string text;
  const Collector& collected = *content.topics;
  std::int64_t first = kNoTime, last = kNoTime;
  for (const TopicAccount& topic : collected.topics()) {
    if (topic.first == kNoTime) continue;
    first = first == kNoTime ? topic.first : std::min(first, topic.first);
    last = last == kNoTime ? topic.last : std::max(last, topic.last);
  }
  text += "# " + content.path() + ": " + content.files.format->title + ", " + std::to_string(collected.messages()) +
          " messages of " + std::to_string(collected.topics().size()) + " topics";
  if (first != kNoTime) text += ", " + formatted("%.1f s", 1e-6 * static_cast<double>(last - first));
  if (collected.recordings() > 1)
    text +=
        ", " + std::to_string(collected.recordings()) + " recordings, one behind the other (their clocks start anew)";
  text += "\n";
  for (const std::string& remark : remarks(content)) text += "#   " + one_line(remark) + "\n";
  text += "#\n# topic (type): messages, rate, longest gap; fields\n";
  for (const TopicAccount& topic : collected.topics()) {
    text += "# " +
            one_line(topic.topic.name + (topic.topic.type == topic.topic.name ? "" : " (" + topic.topic.type + ")")) +
            ": " + std::to_string(topic.messages);
    if (topic.untimed > 0) text += " (" + std::to_string(topic.untimed) + " more without a time)";
    if (const double rate = topic.rate(); rate > 0.0) text += ", " + formatted("%.3g Hz", rate);
    if (topic.longest_gap > 0) text += ", " + formatted("%.3g s", 1e-6 * static_cast<double>(topic.longest_gap));
    std::size_t named = 0;
    for (const Field& field : topic.topic.fields) {
      if (++named > kMostFields) break;
      text += (named == 1 ? "; " : ", ") + one_line(field.name) + (field.unit.empty() ? "" : " [" + field.unit + "]");
    }
    if (named > kMostFields) text += ", and " + std::to_string(topic.topic.fields.size() - kMostFields) + " more";
    if (!topic.words.empty()) text += "; " + one_line(topic.words.substr(0, kMostWords));
    text += "\n";
  }
  text += "#\n";
  return text;
}

}  // namespace fathom::recordings
