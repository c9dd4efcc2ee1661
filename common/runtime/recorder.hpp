// Records a run in lockstep: every message once, in the order in which it was handled, stamped with virtual time, so
// that the log is the same on every machine and a replay of it gives every process what it had.
#pragma once

#include <cstddef>
#include <deque>
#include <fathom_lcm/lockstep_ack_t.hpp>
#include <fathom_lcm/lockstep_t.hpp>
#include <functional>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "common/base/time.hpp"

namespace fathom::runtime {

inline constexpr char kEveryChannel[] = ".*";  ///< what a recorder says that it hears

/// Puts messages into their phases. Pure: writing is passed in.
class Arrangement {
 public:
  using Write = std::function<void(const std::string& channel, std::vector<std::uint8_t>& bytes, Utime utime)>;
  /// `without`: channels that are not written.
  explicit Arrangement(Write write, std::set<std::string> without = {})
      : write_{std::move(write)}, without_{std::move(without)} {}

  void arrived(const std::string& channel, std::vector<std::uint8_t> bytes);
  /// Writes what is complete.
  void announced(const fathom_lcm::lockstep_t& phase);
  /// Number of the newest control interval of which everything announced is written.
  [[nodiscard]] std::int64_t tick() const { return tick_; }
  /// The run has ended and everything is written.
  [[nodiscard]] bool ended() const { return ended_ && phases_.empty(); }
  [[nodiscard]] std::int64_t written() const { return count_; }

 private:
  void write_complete();
  void put(const std::string& channel, Utime utime);
  struct Message {
    std::string channel;
    std::vector<std::uint8_t> bytes;  ///< none: it comes by its own channel
  };
  struct Phase {
    Utime utime{};
    std::int64_t tick{};
    std::int32_t number{};
    std::vector<Message> messages;
  };

  Write write_;
  std::set<std::string> without_;
  std::map<std::string, std::deque<std::vector<std::uint8_t>>> waiting_;
  std::deque<Phase> phases_;
  Utime utime_{};
  std::int64_t tick_{-1}, count_{};
  bool ended_{false};
};

/// The main() of recorder.
int recorder_main(int argc, const char* const* argv);

}  // namespace fathom::runtime
