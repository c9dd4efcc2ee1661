// What learning tells of itself while it goes on, with guessed costs in fits of one candidate.
#pragma once

#include "common/base/progress.hpp"
#include "common/inference/fitted_models.hpp"
#include "common/learning/limits.hpp"

namespace fathom::learning {

constexpr inference::Step kSeek{"learning: force", "looking for what such a force depends on", 6.0};
constexpr inference::Step kClosed{"learning: formula", "fitting closed forms", 1.0};
constexpr inference::Step kLeftOut{"learning: left out", "predicting stretches that were left out", 1.0};
constexpr double kPlacesGuessed = 4.0;  ///< a look at all closed forms, and those that come near

/// Before all else, since nobody knows yet whether something is to be learned.
inline void announce(const Progress& progress, const Limits& limits, const Leaving& leaving) {
  progress.expect(kSeek.phase, limits.rounds, kSeek.weight);
  progress.expect(kClosed.phase, kPlacesGuessed, kClosed.weight);
  progress.expect(kLeftOut.phase, leaving.folds, kLeftOut.weight);
}
/// Nothing of it is to come.
inline void call_off(const Progress& progress) {
  for (const inference::Step& step : {kSeek, kClosed, kLeftOut}) progress.expect(step.phase, 0);
}
/// A step begins that consists of so many.
inline void begin(const Progress& progress, const inference::Step& step, double units) {
  progress.expect(step.phase, units, step.weight);
  progress.begin(step.phase, step.what);
}

}  // namespace fathom::learning
