// Which command lines a deputy may run. An order comes from whoever can send to the bus; a file on the deputy's own
// host says what may come of it.
#pragma once

#include <set>
#include <string>
#include <utility>
#include <vector>

#include "common/samples/launch.hpp"

namespace fathom::launch {

class AllowList {
 public:
  /// The commands that configurations of procman name for this deputy. InputError for a file that cannot be read, and
  /// when there is no such command.
  [[nodiscard]] static AllowList load(const std::vector<std::string>& paths, const std::string& deputy);

  /// Name and command line, letter by letter: $NAMES are filled in later, from the deputy's own environment.
  [[nodiscard]] bool permits(const LaunchCommand& command) const { return lines_.contains({command.id, command.exec}); }
  [[nodiscard]] std::size_t size() const { return lines_.size(); }
  /// "/etc/fathom/allow.cfg", for people.
  [[nodiscard]] const std::string& files() const { return files_; }

 private:
  std::set<std::pair<std::string, std::string>> lines_;
  std::string files_;
};

/// How a deputy's word about its own list begins; the sheriff's --status shows it.
inline constexpr char kAllowed[] = "command lines: ";

}  // namespace fathom::launch
