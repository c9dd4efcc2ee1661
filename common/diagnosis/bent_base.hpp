// Base numbers as forces have them. A fit to trajectories bends where a pilot, or an autopilot that holds the vehicle,
// answers a random force with a memory: thrust then undoes the noise, and masses and drag that are too large foretell
// how little the vehicle moves. What such numbers leave of the thrust is no structure.
#pragma once

#include <span>
#include <vector>

#include "common/model/dynamics.hpp"
#include "common/samples/estimates.hpp"
#include "common/samples/trial.hpp"

namespace fathom::diagnosis {

/// Wrench residuals (force_residual.hpp) of these runs, with the base numbers that leave least of them: one number for
/// all axes that it acts on, each axis weighed by what it has left. Effects keep theirs. `fitted`: the model's numbers
/// with their deviations, about which they are sought; without, within their priors. Where noise drowns the
/// accelerations, as of a ship that turns slowly, forces alone know nothing of them.
[[nodiscard]] std::vector<std::vector<Vector6d>> residuals_unbent(const model::Model& model,
                                                                  std::span<const Trial> trials,
                                                                  std::span<const NamedValue> fitted = {});

}  // namespace fathom::diagnosis
