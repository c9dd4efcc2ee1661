// procman's configuration files: commands, groups and scripts.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "common/samples/launch.hpp"

namespace fathom::launch {

/// What an action of a script is about.
struct Target {
  enum class Kind { kCommand, kGroup, kEverything };
  Kind kind{Kind::kEverything};
  std::string name;
};

enum class Awaited { kRunning, kStopped };

struct Action {
  enum class Verb { kStart, kStop, kRestart, kPause, kAwait, kScript };
  Verb verb{};
  Target target{};
  std::optional<Awaited> awaited{};  ///< also of a start, stop or restart
  int pause_ms{};
  std::string script{};
  int line{};
};

struct Script {
  std::string name;
  std::vector<Action> actions;
  int line{};
};

struct ConfiguredCommand {
  LaunchCommand command;
  std::string deputy;
  int line{};
};

struct LaunchConfig {
  std::string path;
  std::vector<ConfiguredCommand> commands;  ///< in the order in which procman loads them
  std::vector<Script> scripts;

  /// InputError "path:line: ..." for what procman's parser or loader would refuse, and for scripts that name what is
  /// not there or call each other in a circle.
  [[nodiscard]] static LaunchConfig parse(const std::string& text, const std::string& path);
  [[nodiscard]] static LaunchConfig load(const std::string& path);

  /// Nothing when there is none of that name.
  [[nodiscard]] const Script* script(const std::string& name) const;
  /// InputError that names the scripts there are.
  [[nodiscard]] const Script& require_script(const std::string& name) const;
  /// Each once, in the order of appearance.
  [[nodiscard]] std::vector<std::string> deputies() const;
  /// What procman accepts and then stumbles over, one line each: see docs/operations.md.
  [[nodiscard]] std::vector<std::string> traps() const;

  bool ends_in_a_word{false};  ///< no line end after the last word
};

/// A group means its subgroups too.
[[nodiscard]] bool covers(const Target& target, const LaunchCommand& command);

}  // namespace fathom::launch
