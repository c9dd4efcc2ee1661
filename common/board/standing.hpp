// How the trial stands, in the few words at the top of the page: what was last said, and whether that still holds.
#pragma once

#include <optional>
#include <span>
#include <string>

#include "common/board/roll.hpp"
#include "common/samples/commands.hpp"

namespace fathom::board {

/// A word of the page with its colour: "good", "bad", "warn", "go" or "" (none).
struct Badge {
  std::string text;
  std::string kind;
};

struct Standing {
  Badge phase, armed;
  std::string alarm;   ///< red above everything; empty: all is well
  std::string remark;  ///< the same place, in no colour
  bool over{false};    ///< the trial has ended as it should, and everybody has stopped: what is old is no trouble
  bool calm{false};    ///< it has ended as it should, and its supervisor knows: no STATE is missed
};

struct StandingInput {
  const Excitation* trial{};      ///< nullptr: never heard
  double trial_age{};             ///< s
  std::optional<double> heard{};  ///< s since anybody else's word; nothing: never
  std::span<const Roll::Entry> processes{};
};

/// A trial that is over and whose processes have stopped in order is no trouble, however long ago that was. What was
/// armed when it was last heard of is not known to be armed or not, unless the supervisor has stopped since.
[[nodiscard]] Standing standing(const StandingInput& input);

}  // namespace fathom::board
