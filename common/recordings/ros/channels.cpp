#include "common/recordings/ros/channels.hpp"

#include <utility>

namespace fathom::recordings::ros {

std::size_t Channels::open(const std::string& topic, const std::string& type, std::string_view definition,
                           Language language, Layout layout) {
  const std::string key = topic + "\n" + short_name(type) + "\n" + std::string{definition};
  if (const auto found = known_.find(key); found != known_.end()) return found->second;
  std::string text{definition};
  if (text.empty()) text = usual_definition(type);
  std::string reason;
  if (text.empty() && short_name(type) != "std_msgs/Empty")
    return open_unread(topic, type, "whose type " + type + " is not defined in the recording and not a usual one");
  std::shared_ptr<const Definitions> definitions =
      Definitions::parse(type, text, language == Language::kIdl && !definition.empty(), reason);
  if (definitions == nullptr) return open_unread(topic, type, "whose definition cannot be used: " + reason);
  return make(key, topic, type, std::make_unique<Messages>(channels_.size(), std::move(definitions), layout, sink_),
              "");
}

std::size_t Channels::open_unread(const std::string& topic, const std::string& type, const std::string& why) {
  const std::string key = topic + "\n" + type + "\n" + why;
  if (const auto found = known_.find(key); found != known_.end()) return found->second;
  return make(key, topic, type, nullptr, why);
}

std::size_t Channels::make(const std::string& key, const std::string& topic, const std::string& type,
                           std::unique_ptr<Messages> messages, const std::string& why) {
  Channel channel{.topic = channels_.size(), .name = topic, .messages = std::move(messages), .why = why};
  for (int k = names_[topic]++; k > 0; --k) channel.name += "'";  // the same topic with another type
  Topic made{.name = channel.name, .type = type, .fields = {}};
  if (channel.messages) made.fields = channel.messages->fields();
  channel.wanted = sink_.topic(channel.topic, made);
  if (channel.messages) channel.messages->announced();
  known_[key] = channels_.size();
  channels_.push_back(std::move(channel));
  return channels_.size() - 1;
}

void Channels::message(std::size_t number, std::int64_t log, Bytes bytes) {
  Channel& channel = channels_[number];
  if (!channel.messages) {
    damage_.add("messages of " + channel.name + ", " + channel.why);
    sink_.message(channel.topic, {log, kNoTime}, {});
    return;
  }
  if (!channel.wanted) {
    sink_.message(channel.topic, {log, kNoTime}, {});
    return;
  }
  std::int64_t measured = kNoTime;
  const auto values = channel.messages->read(bytes, measured);
  if (!values) {
    damage_.add("messages of " + channel.name + " that do not fit their definition");
    return;
  }
  sink_.message(channel.topic, {log, measured}, *values);
}

}  // namespace fathom::recordings::ros
