// Where messages come from and go to: a live LCM bus or event logs, told apart by their URL.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <exception>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "common/base/event_log.hpp"
#include "common/base/time.hpp"

namespace lcm {
class LCM;
class LogFile;
struct ReceiveBuffer;
}  // namespace lcm

namespace fathom::runtime {

/// "udpm://239.255.76.67:7667?ttl=0" or "file://x.lcmlog". InputError for anything else.
struct Url {
  std::string text;  ///< as given, with a large receive buffer for udpm
  std::string path;  ///< of the log; empty for a live bus
  [[nodiscard]] static Url parse(const std::string& text, const std::string& argument);
  [[nodiscard]] bool live() const { return path.empty(); }
};

/// Several logs as one: events in the order of their time stamps, ties in the order of the arguments.
class MergedLogs {
 public:
  explicit MergedLogs(const std::vector<Url>& urls);
  [[nodiscard]] std::optional<LogEvent> next();
  [[nodiscard]] std::vector<std::string> warnings() const;

 private:
  struct Head {
    EventLog log;
    std::optional<LogEvent> event;
  };
  std::vector<Head> heads_;
  Head* delivered_{nullptr};  ///< its event is refilled at the next call, since the caller still looks at it
};

/// One channel of a live bus with the number of messages that may wait for it.
struct Subscription {
  std::string channel;
  std::size_t capacity{};  ///< 1: only the latest counts, and replacing it is no loss
};

/// Live messages in the order of arrival. liblcm drops the newest message of a full queue and does not say so;
/// this queue drops the oldest and counts.
class LiveInput {
 public:
  struct Message {
    std::size_t subscription{};
    std::vector<std::uint8_t> bytes;
    std::string channel{};  ///< of a subscription to many channels
    Utime received{};       ///< by the kernel's clock
  };

  LiveInput(const std::vector<Url>& urls, const std::vector<Subscription>& subscriptions);
  ~LiveInput();
  LiveInput(const LiveInput&) = delete;
  LiveInput& operator=(const LiveInput&) = delete;

  /// What becomes readable when a message comes. Nothing when no channel is heard.
  [[nodiscard]] std::vector<int> descriptors() const;
  /// Messages are here already: do not wait for more.
  [[nodiscard]] bool pending() const { return !queue_.empty(); }
  /// Returns when a message came, `wake` (a file descriptor) became readable, or the time was up.
  void wait(int wake, int milliseconds);
  /// The next message, nothing when none waits.
  [[nodiscard]] std::optional<Message> next();
  [[nodiscard]] std::uint64_t dropped(std::size_t subscription) const { return slots_[subscription].dropped; }
  /// Of a channel whose latest message alone counts: those that a newer one replaced.
  [[nodiscard]] std::uint64_t skipped(std::size_t subscription) const { return slots_[subscription].skipped; }

 private:
  struct Slot {
    LiveInput* owner{};
    std::size_t index{};
    std::size_t capacity{};
    bool many{false};          ///< channels: the message must say which
    std::size_t waiting{};     ///< messages that will be delivered
    std::size_t superseded{};  ///< messages in the queue, the oldest ones, that will not
    std::uint64_t dropped{};
    std::uint64_t skipped{};  ///< superseded ever
  };
  static void receive(const lcm::ReceiveBuffer* buffer, const std::string& channel, Slot* slot);
  void push(Slot& slot, const lcm::ReceiveBuffer& buffer, const std::string& channel);
  void drain();

  std::vector<Slot> slots_;  ///< never resized once liblcm holds their addresses
  std::deque<Message> queue_;
  std::exception_ptr failure_;  ///< caught inside liblcm's C frames, rethrown outside
  std::vector<std::unique_ptr<lcm::LCM>> buses_;
};

/// Channels whose messages are hundreds of kilobytes.
inline constexpr std::array<std::string_view, 2> kPictures{"CAMERA", "CAMERA_DEBUG"};
[[nodiscard]] bool is_picture(const std::string& channel);

/// The one place messages go to. Pictures stay on their host even where the bus reaches others (ttl above 0): one alone
/// is more than a cable to the surface carries beside everything else, and a message above the network's packet size is
/// lost whole when one packet is.
class Output {
 public:
  explicit Output(const Url& url);
  ~Output();
  Output(const Output&) = delete;
  Output& operator=(const Output&) = delete;

  [[nodiscard]] bool live() const { return bus_ != nullptr; }
  /// A log's event is stamped with `utime`, the message's own, so that the same messages give the same bytes.
  void write(const std::string& channel, std::span<std::uint8_t> bytes, Utime utime);
  /// InputError when not everything reached the disk.
  void finish();

 private:
  [[nodiscard]] lcm::LCM& bus_for(const std::string& channel);

  std::string path_;
  std::string near_url_;  ///< the same bus with ttl 0; empty where it has that already
  std::unique_ptr<lcm::LCM> bus_;
  std::unique_ptr<lcm::LCM> near_;  ///< made for the first picture
  std::unique_ptr<lcm::LogFile> log_;
};

/// Nothing when the bytes are no such message.
template <class Message>
[[nodiscard]] std::optional<Message> message_of(std::span<const std::uint8_t> bytes) {
  Message message{};
  const int length = static_cast<int>(bytes.size());
  if (message.decode(bytes.data(), 0, length) != length) return {};
  return message;
}

template <class Message>
void say(Output& output, const std::string& channel, const Message& message) {
  std::vector<std::uint8_t> bytes(static_cast<std::size_t>(message.getEncodedSize()));
  message.encode(bytes.data(), 0, static_cast<int>(bytes.size()));
  output.write(channel, bytes, message.utime);
}

}  // namespace fathom::runtime
