// What a regression's scatter does not tell of a derivative's error: instruments and reconstruction that are off all
// the time, terms that act and were not selected, and which other term would explain as much.
#pragma once

#include <span>

#include "common/identification/regression/manoeuvre_regression.hpp"

namespace fathom::identification {

/// Fills SelectedTerm::unseen and equivalents of `result`, which was fitted to `runs`.
///
/// Unseen: b = S x_S + U x_U + D d + e, with the selected terms S, the others U, and what lasting errors d of one
/// standard deviation each do to the residual, D: the gain of each load cell or thruster (half of its variance the same
/// in all runs, half each run's own, since nobody says whether cells were set anew between them), roll, pitch and
/// velocity of each run by what SMOOTHED says of itself. Neither x_S nor x_U is larger than such derivatives
/// are, and d is one (normal priors). Least squares on S alone are off by what the posterior of all three says: its
/// variance, and the square of the distance between its mean and theirs.
///
/// Equivalents: columns that in the term's place leave no more than what chance makes of it.
void add_term_errors(const model::Vehicle& vehicle, std::span<const ManoeuvreRows> runs, int axis,
                     const AxisCandidates& candidates, const RegressionSettings& settings, StepwiseResult& result);

}  // namespace fathom::identification
