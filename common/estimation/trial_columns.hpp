// Measured columns that the vehicle's candidates name, on a trial's grid.
#pragma once

#include <span>

#include "common/base/time.hpp"
#include "common/model/vehicle.hpp"
#include "common/samples/recording.hpp"
#include "common/samples/trial.hpp"

namespace fathom::estimation {

/// Fills columns and column_units of a trial that has its times, in seconds after `origin`, and its attitude. A column
/// is one of SIGNAL by its name, or `voltage` of BATTERY. InputError where one is missing or no number; where it tells
/// of less than half of the run, gaps of ten of its steps apart; where a bearing is not in rad.
void add_columns(const Recording& recording, Utime origin, const model::Vehicle& vehicle, Trial& trial);

/// The name of the first column of a candidate that a recording does not have; empty: it has all.
[[nodiscard]] std::string missing_column(const Recording& recording, const model::Candidate& candidate);

}  // namespace fathom::estimation
