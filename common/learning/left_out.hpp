// How a learned force foretells what its weights were not fitted to: stretches of the recordings are left out in turn,
// all numbers fitted to the rest, and predictions compared where nothing was fitted.
#pragma once

#include <memory>
#include <span>

#include "common/base/progress.hpp"
#include "common/learning/limits.hpp"
#include "common/likelihood/fit.hpp"
#include "common/model/learned/learned_force.hpp"

namespace fathom::learning {

struct Judged {
  residual::Compared whole, carried;
  /// As it stands at the end, on the recordings' last part; where it swings, by numbers and frequencies of what is
  /// before that part, since a phase is foretold only beyond what it was fitted to.
  residual::Compared standing;
};

[[nodiscard]] Judged leave_out_in_turn(const likelihood::Problem& problem, std::span<const Trial> trials,
                                       const likelihood::Fit& base, const likelihood::Fit& with,
                                       const model::Visited& visited, const Leaving& leaving, int threads,
                                       const Progress& progress);

/// What later runs on the same clock are told: the force as it stands at the end, without what set in so late that
/// nothing judges it.
[[nodiscard]] model::FreeForce standing_of(const likelihood::Problem& problem, const model::FreeForce& force);

/// A force of a fit as part of a model.
[[nodiscard]] std::shared_ptr<const model::LearnedForce> made(const likelihood::Fit& fit, const model::FreeForce& force,
                                                              const model::Visited& visited);

}  // namespace fathom::learning
