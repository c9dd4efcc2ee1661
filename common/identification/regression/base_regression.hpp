// The base model's parameters by regression on smoothed states: the rows of all axes together, each axis with its own
// first-order autoregressive residual. The counterpart of the recursive identifier, for the same log.
#pragma once

#include <span>
#include <vector>

#include "common/identification/regression/lagged_gram.hpp"
#include "common/model/vehicle.hpp"
#include "common/samples/recording.hpp"

namespace fathom::identification {

/// Smoothed motion and applied wrench of one run.
struct BaseRun {
  std::vector<SmoothedState> states;
  std::vector<Thrusters> thrusters;  ///< with force, or tau
};

struct BaseFit {
  std::vector<NamedValue> parameters;  ///< order of the vehicle file
  Vector6d phi{Vector6d::Zero()};
  Vector6d sigma{Vector6d::Zero()};  ///< N, N m: of the white part
};

/// `rate` rows per second; the vehicle file's priors count as further observations.
[[nodiscard]] BaseFit fit_base(const model::Vehicle& vehicle, std::span<const BaseRun> runs, double rate = 10.0);

}  // namespace fathom::identification
