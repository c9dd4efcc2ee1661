// How the force of the base model changes with the motion: analytic, for the variational equation.
#pragma once

#include "common/model/dynamics.hpp"

namespace fathom::model {

/// d(generalised force)/d[rotation e in B; nu] in still water, base terms alone: R_WB becomes R_WB exp(skew(e)).
/// N and N m per rad, m/s and rad/s.
[[nodiscard]] Eigen::Matrix<double, 6, 9> base_force_slope(const BaseTheta& theta, const Motion& motion);

}  // namespace fathom::model
