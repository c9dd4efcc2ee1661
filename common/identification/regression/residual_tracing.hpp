// Whence a regression's residual comes: what it would be had a measured pull not been known, how much of that goes with
// the pull, and what is left once it is subtracted. Pereira and Duncan found theirs to be "due primarily to the
// umbilical and chain forces"; here it is asked axis by axis.
#pragma once

#include "common/identification/regression/manoeuvre_regression.hpp"

namespace fathom::identification {

/// What a pull did on one axis over time, row by row of one stretch of a run. N or N m
struct PullTrace {
  std::size_t run{};
  double dt{};                          ///< s
  Eigen::VectorXd before, after, pull;  ///< residual without and with the pull subtracted, and the pull itself
};

/// One pull on one axis, all runs together.
struct TracedPull {
  int axis{};
  std::size_t pull{};        ///< index into kPulls
  double before{}, after{};  ///< N or N m: rms of the residual without and with the pull subtracted
  double phi_before{}, phi_after{};
  double correlation{};             ///< of the residual before with the pull, means apart
  std::vector<std::string> gained;  ///< terms that are selected only where the pull is not known
  std::vector<PullTrace> traces;
};

/// Terms are selected anew each time: what a missing force leaves may be taken for a derivative. Pulls that no cell
/// measures are left out.
[[nodiscard]] std::vector<TracedPull> trace_pulls(const model::Vehicle& vehicle, std::span<const ManoeuvreRows> runs,
                                                  const RegressionSettings& settings);

}  // namespace fathom::identification
