// What a process hears and says: as docs/messages.md tells, and as the process itself does.
#pragma once

#include <fstream>
#include <set>
#include <sstream>
#include <string>
#include <vector>

namespace fathom::test {

struct Channels {
  std::set<std::string> hears, says;
};

inline Channels channels_in_docs(const std::string& process) {
  Channels names;
  std::ifstream docs{std::string{FATHOM_SOURCE_DIR} + "/docs/messages.md"};
  for (std::string line; std::getline(docs, line);) {
    if (!line.starts_with("| ") || line.starts_with("| channel")) continue;
    std::vector<std::string> cells;
    std::istringstream row{line};
    for (std::string cell; std::getline(row, cell, '|');) cells.push_back(cell);
    const std::string channel = cells.at(1).substr(1, cells.at(1).find(' ', 1) - 1);
    const auto has = [&](std::size_t column) {
      return cells.at(column).find(process) != std::string::npos ||
             cells.at(column).find("every process") != std::string::npos;
    };
    if (has(4)) names.says.insert(channel);
    if (has(5)) names.hears.insert(channel);
  }
  return names;
}

/// From what --interface prints.
inline Channels channels_of(const std::string& interface) {
  Channels names;
  std::istringstream lines{interface};
  for (std::string verb, channel, type; lines >> verb >> channel >> type;) {
    (verb == "hears" ? names.hears : names.says).insert(channel);
  }
  return names;
}

}  // namespace fathom::test
