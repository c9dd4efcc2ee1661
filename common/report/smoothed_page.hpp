// A reconstructed run drawn as Pereira and Duncan drew theirs (Figures 1 to 6): smoother as lines, forward filter as
// crosses, the truth of a simulated run dashed, and the inclinometer beside them.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "common/estimation/online/kinematic_estimator.hpp"
#include "common/report/page_parts.hpp"
#include "common/samples/recording.hpp"

namespace fathom::report {

/// How a run was smoothed; of one that was smoothed before, nothing is known.
struct Smoothing {
  std::vector<StateEstimate> filtered;                        ///< the forward filter's, at the times of SMOOTHED
  std::vector<estimation::InnovationStatistics> instruments;  ///< how each fared
  std::optional<bool> inclinometer_used;  ///< roll and pitch of AHRS went into the estimate: Figure 4 is no witness
};

/// HTML of one run: a heading and six figures with what they show in numbers; how its instruments fared folds out.
/// `recording` holds SMOOTHED.
[[nodiscard]] std::string smoothed_section(const Recording& recording, const Smoothing& smoothing, Album& album);

/// The same as a page of its own. InputError when gnuplot is missing or refuses a figure.
[[nodiscard]] std::string smoothed_page(const Recording& recording, const Smoothing& smoothing);

}  // namespace fathom::report
