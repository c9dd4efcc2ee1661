// Runs a program and measures it: time, processor time and memory.
#pragma once

#include <string>
#include <vector>

namespace fathom::sealed {

struct Measured {
  int code{};          ///< 128 + signal when it was killed
  double seconds{};    ///< on the wall
  double processor{};  ///< s, all its threads
  double megabytes{};  ///< most that was resident
};

/// `words[0]` is the program's path. What it prints goes to the file `log`.
[[nodiscard]] Measured run_tool(const std::vector<std::string>& words, const std::string& log);

}  // namespace fathom::sealed
