// A command's exec string as procman's deputy reads it: words, settings of the environment, $NAMES. No shell line.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace fathom::launch {

struct ExecLine {
  std::vector<std::pair<std::string, std::string>> settings;  ///< of the environment, in front of the program
  std::vector<std::string> words;                             ///< program and arguments
};

/// Value of a variable in the deputy's environment; nothing when it has none of that name.
using Environment = std::function<std::optional<std::string>(const std::string&)>;

[[nodiscard]] ExecLine parse_exec(const std::string& exec, const Environment& environment);

/// What procman's own deputy would do otherwise than its author meant, one phrase each.
[[nodiscard]] std::vector<std::string> exec_traps(const std::string& exec);

}  // namespace fathom::launch
