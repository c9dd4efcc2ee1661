// How a model's numbers vary together, as result.json tells it.
#pragma once

#include <set>

#include "common/likelihood/fit.hpp"
#include "common/samples/verdict_given.hpp"

namespace fathom::verdict {

/// Names and covariance of a fit's numbers in physical units, weights of a free force left out: correlations by the
/// information of the likelihood, deviations as they are reported (`sigma`, of all numbers). Nothing where the fit is
/// none. `withheld`: axes whose base numbers are not told.
void put_covariance(const likelihood::Fit& fit, const Eigen::VectorXd& sigma, VerdictGiven& given,
                    const std::set<int>& withheld = {});

}  // namespace fathom::verdict
