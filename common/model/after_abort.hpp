// What a vehicle shall do when its trial has ended without its operator's order: its file says it (`after_abort`).
#pragma once

#include <string>

namespace fathom {
class Config;
}

namespace fathom::model {

struct AfterAbort {
  enum class Action { kZero, kHoldDepth, kSurface };
  Action action{Action::kZero};
  double speed{0.2};      ///< m/s, of the depth that is aimed at, on the way to the surface
  double largest{};       ///< N, along the vertical; never more than the supervisor's own limit
  double duration{60.0};  ///< s, then zero thrust
  double blind{};         ///< N, upward beside the trim, where the depth is not known; 0: none

  /// The section; InputError with file and line for what is missing, unknown or in a wrong unit.
  [[nodiscard]] static AfterAbort from(const Config& section);
  /// Of a vehicle file; zero thrust where it says nothing.
  [[nodiscard]] static AfterAbort load(const std::string& path);
};

[[nodiscard]] const char* name(AfterAbort::Action action);

}  // namespace fathom::model
