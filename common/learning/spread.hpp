// What a learned force leaves open where it predicts: how its uncertain numbers spread open-loop predictions, and how
// much of the motion lies where it was not learned.
#pragma once

#include <functional>
#include <span>

#include "common/likelihood/fit.hpp"
#include "common/model/learned/learned_force.hpp"
#include "common/model/rollout.hpp"

namespace fathom::learning {

/// What of a force is told of the windows: all of it, what lasts, or as it stands at a time.
using Telling = std::function<model::FreeForce(const model::FreeForce&)>;

/// Standard deviation at the windows' ends, rms over twenty of them at most: what the covariance of base numbers,
/// effects and weights together makes of the velocities, to first order [m/s, rad/s]. `visited`: by the force.
[[nodiscard]] Vector6d spread_of(const likelihood::Fit& fit, const model::Visited& visited, const Telling& tell,
                                 double input_step, std::span<const model::Window> windows);

/// Share of samples at which some term of the force is beyond what it was learned from, and fades; beside what the
/// model has of the water.
[[nodiscard]] double not_visited(const model::Model& model, const model::LearnedForce& force,
                                 std::span<const Trial> trials);

}  // namespace fathom::learning
