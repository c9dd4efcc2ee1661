// The lumped Fossen model, linear in its parameters: Y(nu_dot, nu, R_WB) theta = tau.
#pragma once

#include <Eigen/Core>

#include "common/base/spatial.hpp"
#include "common/model/parameters.hpp"

namespace fathom::model {

/// Rows X Y Z K M N; columns in the order of BaseParameter.
using BaseRegressor = Eigen::Matrix<double, 6, kBaseParameterCount>;

/// Y without the terms in nu_dot: Coriolis and Munk terms, drag, restoring. `down_B` is R_WB^T e_z.
/// What it leaves out is diag(nu_dot) in the six columns of the masses.
[[nodiscard]] BaseRegressor motion_regressor(const Vector6d& nu, const Eigen::Vector3d& down_B);

/// Y, so that Y theta is the wrench tau [N, N m] at the body origin that the motion needs.
[[nodiscard]] BaseRegressor base_regressor(const Vector6d& nu_dot, const Vector6d& nu, const Eigen::Matrix3d& R_WB);

}  // namespace fathom::model
