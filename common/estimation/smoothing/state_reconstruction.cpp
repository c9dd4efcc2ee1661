#include "common/estimation/smoothing/state_reconstruction.hpp"

#include <algorithm>
#include <cmath>

#include "common/base/error.hpp"
#include "common/base/statistics.hpp"
#include "common/estimation/smoothing/noise_from_rest.hpp"
#include "common/estimation/smoothing/process_tuning.hpp"
#include "common/estimation/smoothing/transponder_check.hpp"
#include "common/estimation/wording.hpp"

namespace fathom::estimation {
namespace {

constexpr double kTuned = 600.0;          // s of the run, at most, by which the process noise is tuned
constexpr double kMostRefused = 0.5;      // of an aid's numbers: it and the others cannot both be right
constexpr double kManyRefused = 0.2;      // of one that takes part in a contradiction: more are no outliers
constexpr double kLargestPosition = 5.0;  // m, standard deviation: more is no position of so small a vehicle
constexpr double kLargestVelocity = 1.0;  // m/s, likewise
constexpr double kUnsure = 0.5;           // of the run that may be less sure than that
constexpr double kContradicts = 10.0;     // standard deviations of both, in the median: no tail of any noise
constexpr double kNoContradiction = 0.1;  // m and m/s: whatever both say, so little harms nobody

void refuse_without_position(const Recording& recording, const KalmanSettings& settings, bool allowed) {
  if (allowed || tells_position(recording, settings) || settings.start) return;
  std::string why;
  for (const std::string& line : unused_instruments(recording, settings)) {
    const std::string part = line.substr(recording.name.size() + 2);
    why += (why.empty() ? " (" : "; ") + part;
  }
  if (!why.empty()) why += ")";
  throw InputError(recording.name + ": nothing that is known tells the position" + why +
                   "; fathom smooth --without-position reconstructs velocity and attitude alone");
}

void refuse_contradictions(const std::string& name, const SmoothedTrial& trial) {
  const auto share = [](const InnovationStatistics& one) {
    const auto all = static_cast<double>(one.used + one.refused);
    return all > 0.0 ? static_cast<double>(one.refused) / all : 0.0;
  };
  if (std::ranges::none_of(trial.statistics, [&](const auto& one) { return share(one) > kMostRefused; })) return;
  std::string who;  // which of them is right their numbers do not say
  for (const InnovationStatistics& one : trial.statistics) {
    if (share(one) > kManyRefused)
      who += (who.empty() ? "" : ", ") + one.name + text(" (%.0f %% refused)", 100.0 * share(one));
  }
  throw InputError(name + ": " + who +
                   ": contradiction between them, or noises stated far too small; 'fathom check' tells of wrong "
                   "places, axes and clocks");
}

void refuse_unsure(const std::string& name, const SmoothedTrial& trial, bool without_position) {
  const auto unsure = [&](Eigen::Index begin, double largest) {
    const auto count = std::ranges::count_if(
        trial.smoothed, [&](const SmoothedState& one) { return !(one.sigma.segment<3>(begin).maxCoeff() <= largest); });
    return static_cast<double>(count) > kUnsure * static_cast<double>(trial.smoothed.size());
  };
  if (!without_position && unsure(0, kLargestPosition)) {
    throw InputError(name + text(": the position is known to no better than %.0f m over most of the run: too little "
                                 "tells it; fathom smooth --without-position reconstructs velocity and attitude alone",
                                 kLargestPosition));
  }
  if (!without_position && unsure(6, kLargestVelocity)) {
    throw InputError(name + text(": the velocity is known to no better than %.0f m/s over most of the run: too little "
                                 "tells it",
                                 kLargestVelocity));
  }
}

/// Median over the run of the distance between two estimates, and of its ratio to what both say of themselves.
struct Apart {
  double distance{}, ratio{};
};

Apart apart(const Recording& recording, const SmoothedTrial& trial, Eigen::Index begin) {
  std::vector<double> distances, ratios;
  auto next = trial.smoothed.begin();
  for (const StateEstimate& state : recording.state) {
    if (!state.valid || !(state.sigma.segment<3>(begin).minCoeff() > 0.0)) continue;
    while (next != trial.smoothed.end() && next->utime < state.utime) ++next;
    if (next == trial.smoothed.end()) break;
    if (next->utime != state.utime) continue;
    const Eigen::Vector3d off = begin == 0 ? Eigen::Vector3d{state.p_WB - next->p_WB}
                                           : Eigen::Vector3d{state.nu.head<3>() - next->nu.head<3>()};
    const Eigen::Vector3d variance =
        state.sigma.segment<3>(begin).cwiseAbs2() + next->sigma.segment<3>(begin).cwiseAbs2();
    distances.push_back(off.norm());
    ratios.push_back(std::sqrt(off.cwiseAbs2().cwiseQuotient(variance).mean()));
  }
  return {median(distances), median(ratios)};
}

void refuse_against_state(const Recording& recording, const SmoothedTrial& trial, bool without_position) {
  const auto check = [&](const char* what, const char* unit, const Apart& found) {
    if (found.ratio <= kContradicts || found.distance <= kNoContradiction) return;
    throw InputError(recording.name + ": the smoothed " + what + " lies " + text("%.3g ", found.distance) + unit +
                     text(" from the log's own STATE, %.0f times what both say of themselves; one of them is wrong "
                          "(fathom smooth --despite-state: it is STATE)",
                          found.ratio));
  };
  if (!without_position) check("position", "m", apart(recording, trial, 0));
  check("velocity", "m/s", apart(recording, trial, 6));
}

}  // namespace

Reconstruction reconstruct_state(const Recording& recording, const TrialFiles& files,
                                 const ReconstructionOptions& options, std::vector<std::string>& notes,
                                 const Progress& progress) {
  auto [settings, noises_stated, process_stated, note, unrecorded] = instruments_of(recording, files);
  if (!note.empty()) notes.push_back(recording.name + ": " + note);
  for (const std::string& signal : unrecorded)
    notes.push_back(recording.name + ": the vehicle file's '" + signal + "' is no column of this recording");
  if (options.model) settings.model = *options.model;
  refuse_without_position(recording, settings, options.without_position);
  for (std::string& line : unused_instruments(recording, settings)) notes.push_back(std::move(line));
  if (!options.stated && !options.noises_stated && !noises_stated)
    settings = noise_from_rest(recording, settings, notes);
  settings = without_wrong_transponders(recording, settings, notes);
  if (!options.stated && !process_stated) {
    settings = tune_process(recording, settings, kTuned, progress);
    notes.push_back(recording.name +
                    text(": most probable process noise: jerk %.3g m/s^2, angular jerk %.3g rad/s^2 per root second",
                         settings.process.jerk, settings.process.angular_jerk));
  }
  Reconstruction result{.settings = settings,
                        .trial = smooth(recording, settings, nullptr, progress, options.filtered)};
  refuse_contradictions(recording.name, result.trial);
  refuse_unsure(recording.name, result.trial, options.without_position);
  if (!options.despite_state) refuse_against_state(recording, result.trial, options.without_position);
  notes.insert(notes.end(), result.trial.notes.begin(), result.trial.notes.end());
  return result;
}

}  // namespace fathom::estimation
