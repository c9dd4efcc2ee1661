// One script at work: gives the sheriff its orders, one action after the other.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "common/launch/sheriff.hpp"

namespace fathom::launch {

/// As procman does it, but for three things: what has failed does not count as running and ends the script at the next
/// wait; a program that speaks runs when it has spoken; and no wait for "running" or for a silent deputy lasts for
/// ever.
class ScriptRun {
 public:
  static constexpr double kPatience = 30.0;  ///< s
  static constexpr double kPause = 0.1;      ///< s between a fulfilled wait and the next action

  static constexpr double kWord = 10.0;  ///< s after which one that should have spoken counts as running all the same
  static constexpr double kStopPatience = 3.0;  ///< s for a silent deputy where the rest must go on

  /// kGoOn: what cannot be done is noted and left behind, as a stop must.
  enum class Care { kGiveUp, kGoOn };
  /// Whether a running program is ready: one that says HEALTH is when it has said some.
  using Ready = std::function<bool(const Sheriff::Row&)>;
  ScriptRun(Sheriff& sheriff, const Script& script, Care care = Care::kGiveUp, Ready ready = {});

  enum class Result { kGoing, kDone, kFailed };
  Result step(double now);
  /// What it waits for, or why it failed; empty when done.
  [[nodiscard]] const std::string& text() const { return text_; }

 private:
  void add(const Script& script);
  bool fulfilled(const Action& action, double now);
  /// Line about a program that this script does not wait for and that has failed; empty when there is none.
  std::string failure_elsewhere(const Action& action, double now);
  Result fail(const Action& action, const std::string& why);
  void next(double now);

  Sheriff& sheriff_;
  Care care_;
  Ready ready_;
  std::vector<Action> actions_;
  std::size_t at_{};
  std::optional<double> waiting_since_{};
  std::optional<double> silent_since_{};
  double not_before_{-1e9};
  std::string text_;
  std::string failed_;
};

}  // namespace fathom::launch
