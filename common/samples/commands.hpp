// What is asked of the vehicle, and what became of it: WRENCH_COMMAND, OPERATOR, ANSWER, EXCITATION.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "common/base/spatial.hpp"
#include "common/base/time.hpp"

namespace fathom {

/// Wrench that the thrusters shall give.
struct WrenchCommand {
  Utime utime{};                   ///< of the state that it answers
  Vector6d tau{Vector6d::Zero()};  ///< N, N m at the body origin, body axes
  double life{};                   ///< s; after utime + life the thruster driver goes to zero
  std::string commander;           ///< who commands, different for every running process
  std::int64_t armed_by{};         ///< sequence of the order that armed the commander; 0: none has
  std::int64_t challenge{};        ///< of that order
  std::int64_t sequence{};         ///< rises with every command
  bool authentic{false};           ///< its signature was right (found on arrival, not carried)
};

/// What the human wants.
struct Operator {
  Utime utime{};                   ///< the vehicle's time when it was given
  std::int64_t sequence{};         ///< above that of the last order that was accepted; of an abort any
  std::int64_t challenge{};        ///< as ANSWER told it
  bool abort{false};               ///< thrust to zero at once
  bool enable{false};              ///< automatic motion is allowed
  std::string order;               ///< "hold", "identify", "manual", "skip", "retry", "fly"; empty: a sign of life
  Vector6d tau{Vector6d::Zero()};  ///< N, N m at the body origin, body axes; under "manual": again and again
  std::string segment;             ///< what to "fly", by name, or a preset's; empty: what EFFECTS proposes
  double duration{};               ///< s of "fly", the segment again and again; 0: as proposed, else once
  double attends{};                ///< s between signs of life at most; 0: nobody stays
  bool authentic{false};           ///< its signature was right (found on arrival, not carried)
};

/// What became of an order; and what the next one must quote.
struct Answer {
  Utime utime{};             ///< the vehicle's time
  std::string process;       ///< who answers
  bool gate{false};          ///< who moves the thrusters: challenge and accepted are its own
  std::int64_t challenge{};  ///< drawn when the gate started
  std::int64_t accepted{};   ///< highest number of an order that was accepted
  std::int64_t sequence{};   ///< of the order that is answered; 0: of none
  bool done{false};          ///< it was accepted and is done
  bool armed{false};         ///< thrust may be given now
  std::string text;          ///< what was done, or why not
  bool authentic{false};     ///< its signature was right (found on arrival, not carried)
};

/// Excitation::mode of a segment that is flown by its name: no mode of the schedule.
inline constexpr char kSegmentMode[] = "segment";

/// The experiment that the supervisor runs, and why.
struct Excitation {
  Utime utime{};
  bool active{false};
  std::string signal;                ///< e.g. "multisine"
  std::string reason;                ///< one sentence: what the experiment shall settle
  double elapsed{};                  ///< s since the experiment began
  double duration{};                 ///< s planned
  Vector6d probe{Vector6d::Zero()};  ///< N, N m: the experiment's share of the command
  std::string mode;                  ///< "yaw", "surge", "sway", "heave", "total", "segment"; empty: none
  std::string phase;                 ///< "disarmed", "approach", "excite", "done", "aborted" or "lost"
  double metric{-1.0};               ///< of MODEL for this mode; -1: not known
  double threshold{};                ///< below which the mode may be left
  std::string missing;               ///< what else is needed to leave the mode
  bool bent{false};                  ///< the fence altered the command
  std::vector<std::string> frozen;   ///< parameters that shall not be learnt now
};

}  // namespace fathom
