// Commands on WRENCH_COMMAND that this supervisor did not send.
#pragma once

#include <array>
#include <cstdint>
#include <fathom_lcm/wrench_command_t.hpp>
#include <string>

#include "common/base/signing.hpp"

namespace fathom::supervisor {

/// A bus gives back what was said on it. What comes that was not sent, or comes twice, is somebody else's; by the
/// signature, since every other field can be copied.
class Strangers {
 public:
  explicit Strangers(std::string commander) : commander_{std::move(commander)} {}

  void sent(const fathom_lcm::wrench_command_t& message);
  /// True when an operator should be told now: the first of some, or the first after a silence.
  bool heard(const fathom_lcm::wrench_command_t& message);
  /// How many, and in whose name; empty while there were none.
  [[nodiscard]] std::string told() const;

 private:
  static constexpr std::size_t kRemembered = 256;  ///< commands that may be on their way: seconds of them
  std::string commander_;
  std::array<Signature, kRemembered> sent_{};
  std::array<bool, kRemembered> waiting_{};  ///< it has not come back yet
  std::size_t next_{};
  std::int64_t count_{}, told_at_{};
  std::string last_;
};

}  // namespace fathom::supervisor
