// Instruments that fail for a while: silent, frozen, late, speaking nonsense, with a clock that jumps. What the other
// processes do about it is what is tested.
#pragma once

#include <string>
#include <vector>

#include "common/simulation/sensor.hpp"

namespace fathom::simulation {

struct Failure {
  enum class Kind { kSilent, kFrozen, kNan, kDelay, kJump };
  std::string sensor;  ///< name of its section
  Kind kind{};
  double from{};     ///< s from the run's start
  double to{1e300};  ///< s
  double by{};       ///< s: of kDelay the additional latency, of kJump what its clock is ahead

  /// "ahrs=silent", "dvl=delay,by:0.5,from:20,to:40". InputError names what is not known.
  [[nodiscard]] static Failure parse(const std::string& text);
  [[nodiscard]] bool acts(double t) const { return t >= from && t < to; }
};

/// Alters what an instrument just said. `held`: what it said last before it froze; kept by the caller.
void fail(const Failure& failure, Utime utime, std::vector<Sample>& samples, const std::vector<Sample>& held);

}  // namespace fathom::simulation
