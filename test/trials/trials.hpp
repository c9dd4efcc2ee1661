// What the tool of simulated trials can be asked for.
#pragma once

#include <string>

#include "test/support/trial_recording.hpp"

namespace fathom::trials {

/// config/vehicles/pap104_half.yaml with its instruments and a process noise tuned on one trial.
struct Setup {
  model::Vehicle vehicle;
  estimation::KalmanSettings instruments;
};
[[nodiscard]] Setup setup();

/// line.lcmlog, zigzag.lcmlog, circle.lcmlog.
void record(const std::string& folder, unsigned seed);
/// figures.html: the six figures of the paper, from a simulated circle.
void figures(const std::string& folder, unsigned seed);
/// NEES and NIS over seeds, and position errors of filter and smoother.
void consistency(int seeds);
/// What was assumed about the trial, varied: errors of the smoother.
void variations();
/// Which terms are selected over seeds, with and without memory in the disturbance, by AR(1) and by plain least
/// squares.
void selection(int seeds);
/// How often every derivative is found, and how well, from what the instruments recorded; load cells have wrong gains.
/// `exact_motion`: as if the smoother erred nowhere, which shows what the forces alone leave unknown.
void recovery(int seeds, double cell_gain, bool exact_motion);
/// dive-1.lcmlog ...: simulated dives for `fathom methods --truth`.
void record_dives(const std::string& folder, int seeds);

}  // namespace fathom::trials
