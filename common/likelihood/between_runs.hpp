// By how much numbers differ from run to run: intervals from the information of one likelihood alone hold if the model
// does, and on real vehicles were 1.6 to 5 times too narrow.
#pragma once

#include "common/likelihood/fit.hpp"

namespace fathom::likelihood {

struct BetweenRuns {
  Eigen::VectorXd spread;  ///< per number: standard deviation from run to run; 0: none is seen, or too few runs tell
  Eigen::VectorXd sigma;   ///< of the numbers over all runs, the spread included
};

/// Each run's own estimate is one Gauss-Newton step from the fit that all share, its prior taken out again; the spread
/// is that of a random effect by the method of moments (DerSimonian and Laird 1986). Runs that say less of a number
/// than its prior does are left out; numbers of one run alone keep the fit's own deviation.
[[nodiscard]] BetweenRuns between_runs(const Problem& problem, const Fit& fit, int threads);

}  // namespace fathom::likelihood
