// How much of what the base model lacks the accepted effects explain. Noise has forgotten itself after a moment, what a
// model lacks has not: the residual's covariance over that moment measures it, whatever the sensors' noise. Noise that
// a filter has coloured takes a longer moment to forget.
#pragma once

#include <array>

#include "common/identification/trajectory_fit.hpp"

namespace fathom::diagnosis {

/// Below this share an accepted effect is more likely the imitation of something else than not: a cause explains nearly
/// everything that it causes, and a stand-in leaves its own wrong form behind. Where right names and stand-ins meet in
/// some two hundred data sets of three simulators (docs/decisions/020).
constexpr double kWholeCause = 0.97;

constexpr double kMostOfIt = 0.5;  ///< of the lasting error: an effect that is there, if perhaps not alone

constexpr double kWhiteNoise = 0.1;     // s: what sensors filter is forgotten by then
constexpr double kFilteredNoise = 0.5;  // s: what an estimator has coloured is forgotten by then

/// Mean square of what lasts in the velocities that a model predicts over windows, whose initial velocity is free, per
/// axis, and the standard error that noise with no more memory would give it, (m/s)^2 and (rad/s)^2.
struct LastingError {
  Vector6d square{Vector6d::Zero()};
  Vector6d error{Vector6d::Zero()};
  Vector6d all{Vector6d::Zero()};  ///< mean square of the whole residual, noise included
};
/// Windows that begin less than `lead` s after their run are left out, if others remain. What lasts outlasts `moment`
/// s: longer than what sensors filter, shorter than a hull's answer.
[[nodiscard]] LastingError lasting_error(const identification::TrajectoryFit& problem, const model::Model& model,
                                         double lead = 0.0, double moment = kWhiteNoise);

/// Beyond what such noise may show.
[[nodiscard]] bool certainly_lacking(const LastingError& error);

/// Share (0..1) of the lasting error of `before` that is gone in `after`, over the axes where something is gone, each
/// with the weight of what is gone from it over what is left there in all. What is left counts only as far as noise
/// cannot be it (two standard errors), and not along axes of `random`, where it is a random force. Where nothing is
/// gone: 0, or 1 if nothing was certainly lacking.
[[nodiscard]] double share_explained(const LastingError& before, const LastingError& after,
                                     const std::array<bool, 6>& random = {});

/// Log odds that a name is right, given that it stands for `share` of what was lacking: even at kWholeCause, four times
/// better for half of that left.
[[nodiscard]] double at_most_for(double share, double log_odds);

}  // namespace fathom::diagnosis
