// What is asked of the vehicle: WRENCH_COMMAND, OPERATOR, EXCITATION.
#pragma once

#include <string>

#include "common/base/spatial.hpp"
#include "common/base/time.hpp"

namespace fathom {

/// Wrench that the thrusters shall give.
struct WrenchCommand {
  Utime utime{};                   ///< of the state that it answers
  Vector6d tau{Vector6d::Zero()};  ///< N, N m at the body origin, body axes
  double life{};                   ///< s; after utime + life the thruster driver goes to zero
};

/// What the human wants.
struct Operator {
  Utime utime{};
  bool abort{false};               ///< thrust to zero at once
  bool enable{false};              ///< automatic motion is allowed
  std::string order;               ///< "hold", "identify", "manual"; empty: no change
  Vector6d tau{Vector6d::Zero()};  ///< N, N m at the body origin, body axes; used under "manual"
};

/// The experiment that the supervisor runs, and why.
struct Excitation {
  Utime utime{};
  bool active{false};
  std::string signal;                ///< e.g. "multisine"
  std::string reason;                ///< one sentence: what the experiment shall settle
  double elapsed{};                  ///< s since the experiment began
  double duration{};                 ///< s planned
  Vector6d probe{Vector6d::Zero()};  ///< N, N m: the experiment's share of the command
};

}  // namespace fathom
