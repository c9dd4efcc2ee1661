// The table that an operator sees: process, host, state, processor, memory, health.
#pragma once

#include <string>
#include <vector>

#include "common/launch/sheriff.hpp"
#include "common/samples/health.hpp"

namespace fathom::launch {

/// The newest HEALTH of every process, by its number and host.
class HealthBoard {
 public:
  static constexpr double kSilence = 3.0;  ///< s
  void hear(const Health& health, double now);
  struct Word {
    std::string state;  ///< as HEALTH has it, "silent", or "" for a program that says none
    std::string detail;
    std::string heard{};  ///< how fast each of its channels comes
  };
  [[nodiscard]] Word of(const Sheriff::Row& row, double now) const;

 private:
  struct Seen {
    Health health;
    double at{};
  };
  std::vector<Seen> seen_;
};

/// One line per command under a heading; lines longer than `width` are cut.
[[nodiscard]] std::string table(const std::vector<Sheriff::Row>& rows, const HealthBoard& health, double now,
                                std::size_t width);

/// What a change of is worth a new table where it cannot be redrawn in place.
[[nodiscard]] std::string gist(const std::vector<Sheriff::Row>& rows, const HealthBoard& health, double now);

}  // namespace fathom::launch
