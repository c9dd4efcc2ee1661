// How a model's numbers vary together, as result.json tells it.
#pragma once

#include <set>

#include "common/likelihood/fit.hpp"
#include "common/samples/verdict_given.hpp"

namespace fathom::verdict {

/// Deviations of a fit's numbers with what the clock of the commands adds to delays and lags, which are told after it:
/// how commands act between rows and by how much they are stamped off shows in no data (likelihood::NumberSettings).
[[nodiscard]] Eigen::VectorXd after_the_commands_clock(const likelihood::Problem& problem, const likelihood::Fit& fit,
                                                       Eigen::VectorXd sigma);

/// Names and covariance of a fit's numbers in physical units, weights of a free force left out: correlations by the
/// information of the likelihood, deviations as they are reported (`sigma`, of all numbers). Nothing where the fit is
/// none. `withheld`: axes whose base numbers are not told.
void put_covariance(const likelihood::Fit& fit, const Eigen::VectorXd& sigma, VerdictGiven& given,
                    const std::set<int>& withheld = {});

}  // namespace fathom::verdict
