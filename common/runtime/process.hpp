// What every process shares: arguments, configuration, the bus, stopping, health. A process registers handlers and
// runs.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "common/base/config.hpp"
#include "common/base/time.hpp"

namespace fathom::runtime {

class CommandLine;

struct Arguments;

class Process {
 public:
  Process(std::string name, Arguments arguments);
  ~Process();
  Process(const Process&) = delete;
  Process& operator=(const Process&) = delete;

  /// Hears every message of a channel; up to 1000 may wait. decode(const Message&) gives a sample, or nothing when the
  /// message is not plausible: it is then counted as rejected and nothing follows from it, its time stamp included.
  /// handler(const Sample&).
  template <class Message, class Decode, class Handler>
  void on(const std::string& channel, Decode decode, Handler handler) {
    subscribe<Message>(channel, kQueue, std::move(decode), std::move(handler));
  }
  /// Hears only the latest message of a channel: for commands and pictures. When reading a log it hears all.
  template <class Message, class Decode, class Handler>
  void on_latest(const std::string& channel, Decode decode, Handler handler) {
    subscribe<Message>(channel, 1, std::move(decode), std::move(handler));
  }
  /// Hears every message of a channel whose clock says nothing of this process's time: a jump in it restarts nothing.
  /// handler(const Message&).
  template <class Message, class Handler>
  void listens_to(const std::string& channel, Handler handler) {
    hears<Message>(channel, kQueue, std::move(handler));
  }
  /// Declares what is said on a channel; needed before publish().
  template <class Message>
  void publishes(const std::string& channel) {
    add_speech(channel, Message::getTypeName());
  }
  template <class Message>
  void publish(const std::string& channel, const Message& message) {
    const int length = message.getEncodedSize();
    buffer_.resize(static_cast<std::size_t>(length));
    message.encode(buffer_.data(), 0, length);
    send(channel, Message::getTypeName(), message.utime);
  }

  /// The input is recorded: nothing is waited for.
  [[nodiscard]] bool reads_logs() const;
  /// On a bus in real time: neither from a log nor in lockstep.
  [[nodiscard]] bool is_live() const;
  /// Counts a message that was decoded but refused; HEALTH shows the counts.
  void reject(const std::string& channel);

  /// This process's section, taken from the one --config file that has it. run() refuses keys that nobody read.
  [[nodiscard]] Config config();
  /// Path of the one --config file with this top-level key, for files that others load (the vehicle).
  [[nodiscard]] std::string config_path(const std::string& key) const;
  /// Whether any --config file has this top-level key.
  [[nodiscard]] bool has_config(const std::string& key) const;

  /// Called when message time jumps back by more than a second: a log started over.
  void on_restart(std::function<void()> callback);
  /// Called some ten times a second in real time, with seconds of a steady clock, whatever comes; never from a log nor
  /// in lockstep, where nothing may depend on the wall's time.
  void on_real_time(std::function<void(double now)> callback);
  /// Called once at the end of the input or at a stop, while publishing is still possible.
  void on_end(std::function<void()> callback);

  /// Waits for something else beside the bus (an instrument): called on a live bus in place of waiting, it returns when
  /// one of the descriptors is readable, when it has served what it waits for, or after so many milliseconds.
  using Wait = std::function<void(std::span<const int> descriptors, int milliseconds)>;
  void waits_with(Wait wait);
  /// Called with every message that was published, as it went out.
  using Overhear = std::function<void(const std::string& channel, std::span<const std::uint8_t> bytes)>;
  void overhears(Overhear overhear);
  /// Ends run() as SIGINT would: what the process served has come to its end.
  void stop();
  /// What HEALTH says beside its counts: "" when all is well, else why the state is "unhealthy"; and details.
  struct Condition {
    std::string unhealthy;
    std::string detail;
  };
  void on_health(std::function<Condition()> ask);
  /// For a handler that waits for its own long work, asked now and then: says HEALTH when a second has passed; false
  /// once SIGINT or SIGTERM has come.
  [[nodiscard]] bool go_on();
  /// HEALTH says this name instead of the process's: of one that may run more than once on a bus, each its own.
  void goes_by(const std::string& name);
  /// Says HEALTH now, not at the next full second: the condition has changed.
  void tell_health();

  /// For an operator: a change of state, never per sample.
  void log_info(const std::string& text);
  void log_warning(const std::string& text);

  /// Serves messages until the input ends or SIGINT or SIGTERM comes.
  void run();

 private:
  static constexpr std::size_t kQueue = 1000;
  static constexpr std::size_t kEverybody = 200;  ///< HEALTH of others that may wait
  /// Decodes and hands over; false when it cannot be decoded.
  using Deliver = std::function<bool(std::span<const std::uint8_t>)>;

  template <class Message, class Decode, class Handler>
  void subscribe(const std::string& channel, std::size_t capacity, Decode decode, Handler handler) {
    hears<Message>(
        channel, capacity,
        [this, channel, decode = std::move(decode), handler = std::move(handler)](const Message& message) mutable {
          const auto sample = decode(message);
          if (!sample) return reject(channel);
          arrived(channel, message.utime);
          handler(*sample);
        });
  }
  template <class Message, class Handler>
  void hears(const std::string& channel, std::size_t capacity, Handler handler) {
    add_hearing(channel, Message::getTypeName(), capacity,
                [handler = std::move(handler)](std::span<const std::uint8_t> bytes) mutable {
                  Message message{};
                  const int length = static_cast<int>(bytes.size());
                  if (message.decode(bytes.data(), 0, length) != length || !is_time(message.utime)) return false;
                  handler(static_cast<const Message&>(message));
                  return true;
                });
  }
  void add_hearing(const std::string& channel, const std::string& type, std::size_t capacity, Deliver deliver);
  void add_speech(const std::string& channel, const std::string& type);
  void send(const std::string& channel, const std::string& type, Utime utime);  ///< what is in buffer_
  void arrived(const std::string& channel, Utime utime);
  void deliver(std::size_t hearing, std::span<const std::uint8_t> bytes);
  void run_logs();
  void run_live();
  void run_lockstep();
  void introduce(Utime utime);
  void watch_twins(std::span<const std::uint8_t> health);
  void report_health(const std::string& state, const std::string& reason);
  [[nodiscard]] std::string interface_text() const;

  struct State;
  std::unique_ptr<State> state_;
  std::vector<std::uint8_t> buffer_;  ///< of the message that is being sent
};

/// A program's name, and the sentence that its --help and its manual page begin with.
struct Program {
  Program(const char* program, std::string does = "A process of Fathom.") : name{program}, sentence{std::move(does)} {}
  std::string name, sentence;
};

/// The main() of every process: reads the arguments, calls setup (which ends with run()), turns every exception into
/// one critical line and exit code 1.
/// `more` adds options of this process alone; what they set is ready when setup is called.
int main(const Program& program, int argc, const char* const* argv, const std::function<void(Process&)>& setup,
         const std::function<void(CommandLine&)>& more = {});

}  // namespace fathom::runtime
