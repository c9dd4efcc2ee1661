#include "common/estimation/smoothing/transponder_check.hpp"

#include <cmath>
#include <limits>
#include <string>

#include "common/base/error.hpp"
#include "common/estimation/smoothing/trial_smoother.hpp"

namespace fathom::estimation {
namespace {

constexpr double kMostSurprise = 4.0;  // mean normalised innovation squared of a transponder in its place; outliers add
constexpr double kHelps = 0.6;         // share of the surprise that leaving the guilty one out leaves

/// Mean surprise over the transponders; `bad` when one is beyond what noise and outliers explain. Infinite when no
/// start is found.
double mean_surprise(const Recording& recording, const KalmanSettings& settings, bool& bad) {
  bad = false;
  try {
    double sum = 0.0;
    int count = 0;
    const std::vector<InnovationStatistics> all = innovations(recording, settings);
    for (std::size_t i = kFirstRange; i < all.size(); ++i) {
      const auto heard = static_cast<double>(all[i].used + all[i].refused);
      if (heard == 0.0) continue;
      const double surprise = all[i].surprise_sum / heard;
      bad = bad || surprise > kMostSurprise;
      sum += surprise;
      ++count;
    }
    return count > 0 ? sum / count : 0.0;
  } catch (const InputError&) {
    bad = true;
    return std::numeric_limits<double>::infinity();
  }
}

}  // namespace

KalmanSettings without_wrong_transponders(const Recording& recording, KalmanSettings settings,
                                          std::vector<std::string>& notes) {
  if (recording.ranges.empty()) return settings;
  for (auto used = settings.transponders.size(); used > 0; --used) {
    bool bad = false;
    const double doubt = mean_surprise(recording, settings, bad);
    if (!bad) return settings;
    if (used <= 3) {
      if (std::isfinite(doubt)) {
        notes.push_back(recording.name + ": the ranges contradict each other; with " + std::to_string(used) +
                        " transponders nothing tells which place is wrong");
      }
      return settings;
    }
    Transponder* guilty = nullptr;
    double best = kHelps * doubt;  // infinite when nothing is found with all of them
    for (Transponder& one : settings.transponders) {
      if (!one.used) continue;
      one.used = false;
      bool still = false;
      const double left = mean_surprise(recording, settings, still);
      one.used = true;
      if (left >= best) continue;
      best = left;
      guilty = &one;
    }
    if (guilty == nullptr) {
      notes.push_back(recording.name +
                      ": the ranges contradict each other, and no single transponder explains it; check the places and "
                      "their order in the file");
      return settings;
    }
    guilty->used = false;
    notes.push_back(recording.name + ": transponder " + guilty->name +
                    " contradicts the others and is left out; correct its place in the file");
  }
  return settings;
}

}  // namespace fathom::estimation
