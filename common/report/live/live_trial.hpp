// What the log of a live trial holds, in words and numbers: modes, parameters, what the diagnoser said. And, in a part
// of its own, the comparison with a simulator's truth.
#pragma once

#include <span>
#include <string>

#include "common/model/site.hpp"
#include "common/model/vehicle.hpp"
#include "common/samples/live_trial.hpp"
#include "common/samples/recording.hpp"
#include "common/samples/result_origin.hpp"
#include "common/samples/vision.hpp"

namespace fathom::estimation {
struct NavigatorSettings;
}

namespace fathom::report {

/// InputError when the log holds no STATE, no MODEL or no EXCITATION. TRUTH is not looked at.
[[nodiscard]] LiveTrialResult summarise(const Recording& recording, const model::Vehicle& vehicle,
                                        const model::Site& site);
/// From the simulator's truth.json and the log's TRUTH; InputError when the file cannot be read.
[[nodiscard]] TruthComparison compare_truth(const std::string& path, const Recording& recording);
/// From the folder of a diagnosis; `page`: its report, as the trial's page shall refer to it. InputError when it is
/// none.
[[nodiscard]] Afterwards read_afterwards(const std::string& folder, const std::string& page);
[[nodiscard]] std::string afterwards_section(const Afterwards& found);
/// "Live trial of ..."; of a run without a supervisor, "Trial of ...".
[[nodiscard]] std::string trial_title(const LiveTrialResult& result);
/// Whose numbers the parameters are: the recursive estimate's or the joint one's, and since when.
[[nodiscard]] std::string estimate_words(const LiveTrialResult& result);
/// That the model lacks something, where its residual has failed its test; else nothing.
[[nodiscard]] std::string doubt_words(const LiveTrialResult& result);
/// First time stamp of the states: zero of every time axis.
[[nodiscard]] Utime trial_origin(const Recording& recording);

/// JSON text for programs, as docs/schema/live_trial-1.schema.json describes it.
[[nodiscard]] std::string to_json(const LiveTrialResult& result, const ResultOrigin& origin = {});
/// Plain text for a terminal, at most 100 columns.
[[nodiscard]] std::string to_table(const LiveTrialResult& result);
/// The page: one HTML file that opens without a network. InputError when gnuplot cannot draw. `pictures`: of its
/// contact sheet, JPEG files with what was measured drawn in; none: no sheet. `filters`: the estimator's settings, for
/// Figures 1.4 and 1.5; null: without these.
[[nodiscard]] std::string to_html(const LiveTrialResult& result, const Recording& recording,
                                  const model::Vehicle& vehicle, const model::Site& site,
                                  std::span<const Camera> pictures = {},
                                  const estimation::NavigatorSettings* filters = nullptr,
                                  const std::string& gnuplot = "gnuplot");

}  // namespace fathom::report
