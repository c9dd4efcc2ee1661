// What drives a craft, as the columns of a stranger's table say it: the draft of a map's section `thrusters`.
#pragma once

#include <string>
#include <vector>

#include "common/recordings/draft_columns.hpp"
#include "common/recordings/table_draft.hpp"

namespace fathom::recordings {

struct ThrustDraft {
  std::string lines;   ///< of the section; empty: nothing drives the craft by these columns
  std::string remark;  ///< a comment where nothing does: what is missing, and what to write
};

/// Commands of the vehicle's actuators, else pulses, else a wrench, else what a Slocum drives itself by.
[[nodiscard]] ThrustDraft thrust_of(const Columns& all, const std::vector<Commanded>& actuators);

}  // namespace fathom::recordings
