// Whether a command may reach the thrusters now. Everything doubtful means zero thrust.
#pragma once

#include <optional>
#include <string_view>

#include "common/samples/commands.hpp"

namespace fathom::driver {

/// Zero until it is sure that somebody means it: commands that were flowing already when the driver started count only
/// after a pause of half a second or an operator's "enable". An abort holds until the next "enable". A command dies
/// after its stated life, after half a second without a new one, and when its own time is too old.
class ThrusterGate {
 public:
  static constexpr double kPause = 0.5;  ///< s
  /// Times are wall-clock microseconds, as in messages.
  explicit ThrusterGate(Utime start) : quiet_since_{start} {}

  void hear(const WrenchCommand& command, Utime now);
  void hear(const Operator& order, Utime now);
  /// The wrench to give now; zero whenever reason() says why.
  [[nodiscard]] Vector6d wrench(Utime now) const;
  /// Empty while a command is obeyed.
  [[nodiscard]] std::string_view reason(Utime now) const;

 private:
  Utime quiet_since_;  ///< start, or the last command that was heard while not trusted
  bool trusted_{false};
  bool aborted_{false};
  std::optional<WrenchCommand> command_;
  Utime heard_{};
};

}  // namespace fathom::driver
