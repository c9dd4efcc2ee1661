// What the operator sees: on a terminal a table that is drawn anew in its place, elsewhere a line for every change.
#pragma once

#include <string>
#include <vector>

#include "common/launch/table.hpp"

namespace fathom::sheriff {

class Screen {
 public:
  Screen();
  void show(const std::vector<launch::Sheriff::Row>& rows, const launch::HealthBoard& health, const std::string& doing,
            double now);
  /// The whole table, to stay.
  void finish(const std::vector<launch::Sheriff::Row>& rows, const launch::HealthBoard& health, double now);
  /// A line above the table.
  void say(const std::string& line);
  /// Takes the table away.
  void clear();

 private:
  [[nodiscard]] std::size_t width() const;

  bool terminal_{false};
  int lines_{};  ///< of the table on the terminal
  double drawn_{-1e9};
  std::vector<std::string> told_;  ///< last line of each row
};

}  // namespace fathom::sheriff
