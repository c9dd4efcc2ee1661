#include "common/diagnosis/carried_over.hpp"

#include <algorithm>
#include <cmath>

#include "common/diagnosis/left_over.hpp"
#include "common/identification/trajectory_fit.hpp"

namespace fathom::diagnosis {
namespace {

constexpr double kMostHarm = 0.02;  // growth of the validation error: what predicts worse is not what the model lacked
constexpr double kPromised = 0.1;   // of the training error: so much must show elsewhere
constexpr double kKept = 0.25;      // of what was promised
constexpr double kWorthKeeping = 0.05;  // fall of the validation error

}  // namespace

bool carries_over(const SearchResult& found, const Interval& change, double foreseen) {
  double left = 1.0;
  for (const Judged& judged : found.accepted) left *= 1.0 - judged.error_reduction;
  const double promised = std::min(1.0 - left, foreseen);
  if (!std::isfinite(change.value)) return true;
  return change.value > -kMostHarm && (promised < kPromised || change.value > kKept * promised);
}

double share_on(std::span<const Trial> unseen, const SearchResult& found, const model::Vehicle& vehicle,
                const Settings& settings, const std::array<bool, 6>& random) {
  if (identification::cut_windows(unseen, found.window).empty()) return 1.0;
  identification::FitSettings fits = settings.fit;
  fits.window = found.window;
  const identification::TrajectoryFit windows{vehicle, unseen, fits};
  const double lead = lead_of(found.after.model);
  double share = 0.0;
  for (const double moment : {kWhiteNoise, kFilteredNoise}) {
    const LastingError before = lasting_error(windows, found.before.model, lead, moment);
    // Where nothing lasts so long, nothing is told by its absence.
    if (moment > kWhiteNoise && !certainly_lacking(before)) continue;
    share = std::max(share, share_explained(before, lasting_error(windows, found.after.model, lead, moment), random));
  }
  return share;
}

bool worth_keeping(double share, const Interval& change) {
  if (share >= kMostOfIt || !std::isfinite(change.value)) return true;
  return change.value >= kWorthKeeping && change.low > 0.0;
}

}  // namespace fathom::diagnosis
