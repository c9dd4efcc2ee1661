// A reconstructed run drawn as Pereira and Duncan drew theirs (Figures 1 to 6): smoother as lines, forward filter as
// crosses, the truth of a simulated run dashed, and the inclinometer beside them.
#pragma once

#include <span>
#include <string>

#include "common/samples/recording.hpp"

namespace fathom::report {

/// HTML of one run: a heading and six figures with what they show in numbers. `recording` holds SMOOTHED; `filtered` is
/// the forward filter at the same times. `inclinometer_used`: roll and pitch of AHRS went into the estimate, so that
/// Figure 4 is no witness. Error when gnuplot is missing or refuses a figure.
[[nodiscard]] std::string smoothed_figures(const Recording& recording, std::span<const StateEstimate> filtered,
                                           bool inclinometer_used);

/// The same as a page of its own.
[[nodiscard]] std::string smoothed_page(const Recording& recording, std::span<const StateEstimate> filtered,
                                        bool inclinometer_used);

}  // namespace fathom::report
