// Lockstep: virtual time as fast as the machine allows, and the same messages in the same order at every speed. The
// simulator conducts, all others follow; no mind knows of it. docs/decisions/011-lockstep.md tells why it is built so.
#pragma once

#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <fathom_lcm/lockstep_ack_t.hpp>
#include <fathom_lcm/lockstep_t.hpp>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "common/base/time.hpp"

namespace fathom::runtime {

inline constexpr char kLockstep[] = "LOCKSTEP";
inline constexpr char kLockstepAck[] = "LOCKSTEP_ACK";

/// Channels that come when they come: no phase waits for them, and nobody lists what he says there.
inline constexpr std::array<std::string_view, 3> kFreeChannels{"OPERATOR", "HEALTH", "PROCESS_INFO"};
[[nodiscard]] bool is_free_channel(const std::string& channel);

/// Messages that are not enclosed in LOCKSTEP: those that nobody waits for, and pictures, which are too large.
[[nodiscard]] bool travels_alone(const std::string& channel);

/// What somebody said in a phase, in order.
struct Said {
  std::vector<std::string> channel;
  std::vector<std::int32_t> size{};  ///< byte, of each message; 0: it travels alone
  std::vector<std::uint8_t> bytes{};
  void add(const std::string& name, std::span<const std::uint8_t> message);
};

/// The bytes of each message of a phase; none where it travels alone. InputError when the sizes are not those of the
/// bytes.
[[nodiscard]] std::vector<std::span<const std::uint8_t>> enclosed(const fathom_lcm::lockstep_t& phase);

/// A process's side: keeps messages until their phase is announced.
class Follower {
 public:
  struct Message {
    std::size_t hearing{};
    std::vector<std::uint8_t> bytes;
  };

  /// `heard`: channels in the order of the process's hearings.
  Follower(std::string name, std::vector<std::string> heard);

  void arrived(std::size_t hearing, std::vector<std::uint8_t> bytes);
  void announced(const fathom_lcm::lockstep_t& phase);
  /// The messages of the next phase, in order, once all of them are here; nothing before. An empty list never comes.
  [[nodiscard]] std::optional<std::vector<Message>> next();
  /// Takes a message that was said in the phase that next() gave.
  void said(const std::string& channel, std::span<const std::uint8_t> bytes);
  /// The answer to that phase.
  [[nodiscard]] fathom_lcm::lockstep_ack_t answer();
  /// What is said until the first phase comes.
  [[nodiscard]] fathom_lcm::lockstep_ack_t hello() const;
  [[nodiscard]] bool started() const { return started_; }
  /// It is this process's turn to end: what it says meanwhile belongs to the answer, and then it goes.
  [[nodiscard]] bool ends() const { return ends_ && phases_.empty(); }

 private:
  [[nodiscard]] bool heard(const std::string& channel) const;

  std::string name_;
  std::vector<std::string> heard_;
  std::vector<std::deque<std::vector<std::uint8_t>>> waiting_;  ///< per hearing
  std::deque<fathom_lcm::lockstep_t> phases_;
  fathom_lcm::lockstep_ack_t answer_{};
  Said said_;
  bool started_{false}, ends_{false};
};

/// The simulator's side: who has to answer, and when a control interval is over.
class Conductor {
 public:
  static constexpr std::int64_t kRecorderEvery = 8;    ///< intervals after which a recorder tells how far it is
  static constexpr std::int64_t kRecorderBehind = 64;  ///< intervals that it may be behind

  /// `names`: the processes to wait for; what they say in one phase is handled in this order.
  explicit Conductor(std::vector<std::string> names);

  /// InputError when a stranger answers, or somebody who has already begun says hello again.
  void hear(const fathom_lcm::lockstep_ack_t& ack);
  /// Those who have not said hello yet.
  [[nodiscard]] std::vector<std::string> absent() const;
  /// Begins a control interval with what the simulator said in it. To be published.
  [[nodiscard]] fathom_lcm::lockstep_t begin(Utime utime, Said said);
  /// The phase to be published next; nothing while answers are missing or when the interval is over.
  [[nodiscard]] std::optional<fathom_lcm::lockstep_t> next();
  /// Nobody has anything left to handle.
  [[nodiscard]] bool over() const;
  /// Messages that were said on a channel by all since the start.
  [[nodiscard]] std::int64_t said(const std::string& channel) const;
  /// Who has not answered yet, for an operator.
  [[nodiscard]] std::string waiting_for() const;
  /// The run is over: each process ends in its turn, in the order of the names, so that those behind it still hear its
  /// last words. To be published whenever an interval is over; nothing once all have been told.
  [[nodiscard]] std::optional<fathom_lcm::lockstep_t> finish(Utime utime);
  /// Ends all at once.
  [[nodiscard]] fathom_lcm::lockstep_t end(Utime utime) const;

 private:
  void call();
  void clear();
  void enclose(Said&& said);

  std::vector<std::string> names_;
  std::map<std::string, std::vector<std::string>> heard_;  ///< by process
  std::map<std::string, Said> said_;                       ///< in this phase, by process
  std::map<std::string, std::int64_t> total_;
  std::map<std::string, std::int64_t> recorded_;  ///< newest interval that a recorder has written, by its name
  std::vector<std::string> waiting_for_;
  fathom_lcm::lockstep_t phase_{};
  std::string ending_;  ///< the process whose turn it is, or was
  bool finished_{false};
  bool answered_{false};  ///< all have answered a phase and next() has not been asked yet
};

}  // namespace fathom::runtime
