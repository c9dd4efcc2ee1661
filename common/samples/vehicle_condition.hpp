// VEHICLE: what stands behind the thruster driver, armed or not, in which mode, and what it says of itself.
#pragma once

#include <string>
#include <vector>

#include "common/base/spatial.hpp"
#include "common/base/time.hpp"

namespace fathom {

/// Words of the vehicle itself.
struct VehicleText {
  int severity{7};  ///< 0 emergency ... 4 warning ... 7 debug, as MAVLink and syslog have it
  std::string text;
  double age{};  ///< s since it was said last
};

/// One condition that must hold before a trial and in it.
struct ConditionLine {
  std::string name;   ///< "heartbeat", "armed", "mode", "voltage", "failsafe", "thrust", ...
  bool ok{true};      ///< it holds
  bool grave{false};  ///< where it does not: no trial goes on, and nobody waits whether it passes
  std::string text;   ///< what is so; where it does not hold, with the remedy
};

struct VehicleCondition {
  Utime utime{};
  std::string kind;            ///< "ArduSub", "rig" or "dry run"
  double heartbeat_age{-1.0};  ///< s since its last sign of life; -1: none has come
  int armed{-1};               ///< 1 armed, 0 disarmed, -1 not told
  std::string mode;            ///< by its own name; empty: not told
  bool failsafe{false};        ///< it says that a failsafe of its own is active
  double voltage{};            ///< V, under load; 0: not told
  double voltage_floor{};      ///< V, below which no trial begins and one ends; 0: none is known
  Vector6d asked{Vector6d::Zero()};
  bool has_applied{false};
  Vector6d applied{Vector6d::Zero()};  ///< N, N m at the body origin, body axes, like `asked`
  std::vector<VehicleText> texts{};    ///< of the last half minute, warnings and worse
  std::vector<ConditionLine> lines{};
};

}  // namespace fathom
