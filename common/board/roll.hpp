// Who is on the bus: the newest HEALTH of every process, who has fallen silent, and who is there twice.
#pragma once

#include <string>
#include <vector>

#include "common/launch/table.hpp"
#include "common/samples/health.hpp"

namespace fathom::board {

/// Pure: times are passed in, in seconds of any steady clock.
class Roll {
 public:
  static constexpr double kSilence = launch::HealthBoard::kSilence;  ///< s, as in the sheriff's table
  static constexpr std::size_t kMost = 64;                           ///< of names that a hostile publisher may make up

  void hear(const Health& health, double now);

  struct Entry {
    Health health;
    double age{};         ///< s since its last word
    std::string state;    ///< as HEALTH has it, or "silent"
    std::string detail;   ///< what it complains of
    bool second{false};   ///< another process of its name speaks meanwhile
    bool healthy{false};  ///< "running" and alone
    int returns{};        ///< how often a new process took the place of one of this name that had ended on this host
  };
  /// By name, then host and number.
  [[nodiscard]] std::vector<Entry> entries(double now) const;

 private:
  struct Seen {
    Health health;
    double first{}, last{};
    int returns{};
  };
  [[nodiscard]] static bool gone(const Seen& seen, double now);
  void succeed(Seen& heir, double now);
  std::vector<Seen> seen_;
};

}  // namespace fathom::board
