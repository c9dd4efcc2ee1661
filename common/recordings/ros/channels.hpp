// Topics of a recording of ROS: from a topic's name, type and definition to numbers.
#pragma once

#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "common/recordings/damage.hpp"
#include "common/recordings/ros/message.hpp"
#include "common/recordings/topic.hpp"

namespace fathom::recordings::ros {

enum class Language : std::uint8_t { kMsg, kIdl };

class Channels {
 public:
  Channels(Sink& sink, Damage& damage) : sink_(sink), damage_(damage) {}

  /// A number for message(). The same topic, type and definition give the same topic again.
  std::size_t open(const std::string& topic, const std::string& type, std::string_view definition, Language language,
                   Layout layout);
  /// A topic whose messages are counted and not read; `why` completes "messages of /topic, ...".
  std::size_t open_unread(const std::string& topic, const std::string& type, const std::string& why);
  /// `log`: us.
  void message(std::size_t channel, std::int64_t log, Bytes bytes);

 private:
  struct Channel {
    std::size_t topic{};
    std::string name;
    std::unique_ptr<Messages> messages;
    bool wanted{};
    std::string why;  ///< it is not read
  };
  std::size_t make(const std::string& key, const std::string& topic, const std::string& type,
                   std::unique_ptr<Messages> messages, const std::string& why);

  Sink& sink_;
  Damage& damage_;
  std::vector<Channel> channels_;
  std::map<std::string, std::size_t> known_;  ///< by topic, type and definition
  std::map<std::string, int> names_;          ///< how often a topic's name was taken
};

}  // namespace fathom::recordings::ros
