// What the columns of a table are, and the draft of a map of those with usual names.
#pragma once

#include <string>
#include <vector>

#include "common/tables/csv.hpp"

namespace fathom::recordings {

/// What a vehicle file's actuator is called, and what commands it.
struct Commanded {
  enum class By { kForce, kPulses, kShaftSpeed, kAngle, kOther };
  std::string name;
  By by{By::kOther};
};

/// Columns with count, unit and range as comments of YAML, then a map that runs as it is where a time and at least one
/// stream have usual names; without them the comments alone. Components that no column has are 'none'. `actuators`: of
/// the vehicle, in its file's order; what commands them is drafted where each has a column of its name or a usual one.
[[nodiscard]] std::string describe_table(const tables::CsvTable& table, const std::vector<Commanded>& actuators = {});

}  // namespace fathom::recordings
