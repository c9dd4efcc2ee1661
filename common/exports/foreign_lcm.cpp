#include "common/exports/foreign_lcm.hpp"

#include <algorithm>
#include <fstream>
#include <iterator>
#include <limits>
#include <map>
#include <sstream>
#include <unordered_map>
#include <vector>

#include "common/base/error.hpp"
#include "common/base/event_log.hpp"
#include "common/exports/any_message.hpp"
#include "common/exports/log_visit.hpp"

namespace fathom::exports {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kMissing = std::numeric_limits<double>::quiet_NaN();
constexpr recordings::Format kLog{
    .name = "lcm", .title = "LCM log", .clock = {}, .recognises = nullptr, .read = nullptr};

/// The messages of one type on one channel.
struct Channel {
  std::size_t number{};
  recordings::Topic topic;
  std::unordered_map<std::string, std::size_t> places;
  std::vector<double> values;
  bool opened{};
};

double number_of(const Json& value) {
  if (value.is_boolean()) return value.get<bool>() ? 1.0 : 0.0;
  return value.is_number() ? value.get<double>() : kMissing;
}

/// When a message was measured, as it says itself: LCM's users count microseconds.
std::int64_t measured_at(const Json& message) {
  for (const Json* holder : {&message, message.contains("header") ? &message.at("header") : &message}) {
    if (!holder->is_object() || !holder->contains("utime") || !holder->at("utime").is_number_integer()) continue;
    const auto utime = holder->at("utime").get<std::int64_t>();
    if (utime > 0) return utime;
  }
  return recordings::kNoTime;
}

std::string fingerprint_of(std::span<const std::uint8_t> bytes) {
  std::ostringstream text;
  text << std::hex;
  for (const unsigned byte : bytes.first(std::min<std::size_t>(bytes.size(), 8))) text << (byte >> 4U) << (byte & 15U);
  return text.str();
}

class Reader {
 public:
  Reader(const Definitions& definitions, recordings::Sink& sink, recordings::Damage& damage)
      : definitions_{definitions}, sink_{sink}, damage_{damage} {}

  void read(const std::string& path) {
    EventLog log{path};
    while (const auto event = log.next()) {
      if (event->begins_anew)
        throw InputError(path + ": holds several recordings joined together: another one begins at event " +
                         std::to_string(log.events()) + " (byte " + std::to_string(event->offset) +
                         "). Part them with: fathom repair-log LOG --out PART.lcmlog");
      take(*event);
    }
    if (!log.warning().empty()) damage_.add("events cut off by the end of the log");
  }

 private:
  void take(const LogEvent& event) {
    const std::string name{event.channel};
    const Type* type = definitions_.type_of(event.data);
    if (type == nullptr) {
      const std::string which = event.data.size() < 8
                                    ? "too short to have a type"
                                    : "of a type that no file defines (fingerprint " + fingerprint_of(event.data) + ")";
      damage_.add("messages on channel '" + name + "' " + which, event.offset, event.data.size());
      return;
    }
    const std::optional<Json> message = decoded(definitions_, *type, event.data, Bytes::kCount);
    if (!message) {
      damage_.add("messages on channel '" + name + "' that are not what their type says", event.offset,
                  event.data.size());
      return;
    }
    Channel& channel = channel_of(name, *type);
    channel.values.assign(channel.topic.fields.size(), kMissing);
    flatten(*message, "", [&](const std::string& field, const Json& value) { put(channel, field, value); });
    if (!channel.opened) static_cast<void>(sink_.topic(channel.number, channel.topic));
    channel.opened = true;
    sink_.message(channel.number, {.log = event.time, .measured = measured_at(*message)}, channel.values);
    flatten(*message, "", [&](const std::string& field, const Json& value) {
      if (value.is_string()) sink_.text(channel.number, field, value.get_ref<const std::string&>());
    });
  }

  Channel& channel_of(const std::string& name, const Type& type) {
    const auto [found, fresh] = channels_.try_emplace({name, &type});
    Channel& channel = found->second;
    if (!fresh) return channel;
    channel.number = channels_.size() - 1;
    // A channel whose type changed is two topics.
    for (int k = names_[name]++; k > 0; --k) channel.topic.name += "'";
    channel.topic.name = name + channel.topic.name;
    channel.topic.type = type.package + "." + type.name;
    return channel;
  }

  void put(Channel& channel, const std::string& field, const Json& value) {
    if (value.is_string()) return;
    const auto [place, fresh] = channel.places.try_emplace(field, channel.topic.fields.size());
    if (fresh) {
      channel.topic.fields.push_back({field});
      channel.values.push_back(kMissing);
      if (channel.opened) sink_.further_field(channel.number, channel.topic.fields.back());
    }
    channel.values[place->second] = number_of(value);
  }

  const Definitions& definitions_;
  recordings::Sink& sink_;
  recordings::Damage& damage_;
  std::map<std::pair<std::string, const Type*>, Channel> channels_;
  std::map<std::string, int> names_;
};

}  // namespace

ForeignLcm::ForeignLcm(std::span<const std::string> paths) {
  std::vector<std::string> texts;
  for (const std::string& path : paths) {
    std::ifstream file{path, std::ios::binary};
    if (!file) throw InputError(path + ": cannot be read");
    texts.emplace_back(std::istreambuf_iterator<char>{file}, std::istreambuf_iterator<char>{});
  }
  const std::vector<std::string_view> views{texts.begin(), texts.end()};
  definitions_ = std::make_shared<const Definitions>(views, paths);
}

recordings::Files ForeignLcm::files(std::span<const std::string> logs) const {
  return {.paths = {logs.begin(), logs.end()},
          .format = &kLog,
          .read = [definitions = definitions_](const std::string& path, recordings::Sink& sink,
                                               recordings::Damage& damage) {
            Reader{*definitions, sink, damage}.read(path);
          }};
}

}  // namespace fathom::exports
