#include "processes/fathom/smoothing.hpp"

#include <algorithm>
#include <optional>
#include <utility>

#include "common/base/error.hpp"
#include "common/base/progress_line.hpp"
#include "common/consistency/consistency.hpp"
#include "common/estimation/corrected_recording.hpp"
#include "common/report/text.hpp"

namespace fathom::tool {
namespace {

constexpr double kMostRefused = 0.2;  // of an instrument's numbers: more are no outliers

double refused_share(const estimation::InnovationStatistics& one) {
  const auto refused = static_cast<double>(one.refused), all = static_cast<double>(one.used + one.refused);
  return all > 0.0 ? refused / all : 0.0;
}

/// Share of an instrument's numbers that was refused, of the one that most of was.
double most_refused(const estimation::SmoothedTrial& trial) {
  double most = 0.0;
  for (const estimation::InnovationStatistics& one : trial.statistics) most = std::max(most, refused_share(one));
  return most;
}

/// As recorded. Where the instruments contradict each other, so that this is refused or refuses more of one than
/// outliers are, once more with what the comparison of sensors corrects: axes, clocks, scales.
estimation::Reconstruction reconstructed(const Recording& recording, const estimation::TrialFiles& files,
                                         const estimation::ReconstructionOptions& asked,
                                         std::vector<std::string>& notes, const Progress& progress) {
  std::optional<estimation::Reconstruction> first;
  std::string why;
  try {
    first = estimation::reconstruct_state(recording, files, asked, notes, progress);
    if (most_refused(first->trial) <= kMostRefused) return std::move(*first);
    why = recording.name + ": much of one instrument is refused";
  } catch (const InputError& refused) {
    why = refused.what();
  }
  const consistency::ConsistencyResult checked = consistency::check_consistency({&recording, 1});
  std::string what;
  for (const ConsistencyFinding& one : checked.findings) {
    if (one.action.starts_with("corrected"))
      what += (what.empty() ? "" : ", ") + one.signal + " (" + report::effect_title(one.finding) + ")";
  }
  if (!what.empty()) {
    notes.push_back(why + "; once more with what the comparison of sensors corrects: " + what);
    try {
      auto again = estimation::reconstruct_state(estimation::corrected(recording, checked.corrections.front()), files,
                                                 asked, notes, progress);
      if (!first || most_refused(again.trial) < most_refused(first->trial)) return again;
      notes.push_back(recording.name + ": that refuses no less; as recorded");
    } catch (const InputError& error) {
      if (!first) throw InputError(std::string{error.what()} + " (corrected: " + what + ")");
    }
  }
  if (!first) throw InputError(why);
  return std::move(*first);
}

}  // namespace

SmoothedRun smoothed_run(Recording recording, const TrialFileOptions& named,
                         const estimation::ReconstructionOptions& asked, std::vector<std::string> notes) {
  const estimation::TrialFiles files = trial_files(named, recording, notes);
  ProgressLine line;
  const auto tell = [&] {
    for (const std::string& note : notes) line.say(note);
    notes.clear();
  };
  tell();
  try {
    estimation::Reconstruction found = reconstructed(recording, files, asked, notes, line.progress());
    for (const estimation::InnovationStatistics& one : found.trial.statistics) {
      if (const double share = refused_share(one); share > kMostRefused)
        notes.push_back(recording.name + ": " + one.name + ": " + report::percent(share) +
                        " refused; its noise is stated too small, or it contradicts the others (fathom check)");
    }
    tell();
    recording.state.clear();
    recording.smoothed = std::move(found.trial.smoothed);
    return {.recording = std::move(recording), .found = std::move(found)};
  } catch (const InputError&) {
    tell();
    throw;
  }
}

report::Smoothing smoothing_of(estimation::Reconstruction&& found) {
  return {.filtered = std::move(found.trial.filtered),
          .instruments = std::move(found.trial.statistics),
          .inclinometer_used = found.settings.attitude == estimation::AttitudeUse::kEverything};
}

}  // namespace fathom::tool
