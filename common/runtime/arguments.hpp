// The command line that every process understands.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "common/runtime/bus.hpp"
#include "common/runtime/process.hpp"

namespace fathom::runtime {

class CommandLine;

/// Adds a process's own options to the common ones.
using MoreOptions = std::function<void(CommandLine&)>;

struct Arguments {
  std::vector<std::string> config;  ///< paths
  std::vector<Url> in;              ///< all live or all logs
  Url out;
  std::string log_level{"info"};
  bool interface_only{false};
  bool lockstep{false};

  /// Nothing when help or version was asked for and printed. InputError for anything else than a good command line.
  [[nodiscard]] static std::optional<Arguments> parse(const Program& program, int argc, const char* const* argv,
                                                      const MoreOptions& more = {});
};

}  // namespace fathom::runtime
