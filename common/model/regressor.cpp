// Kirchhoff's equations in body axes with momenta P = diag(m_X, m_Y, m_Z) v and L = diag(I_X, I_Y, I_Z) w (Fossen 2011,
// ch. 6: diagonal M, no current), here ordered by parameter:
//   M nu_dot + [w x P; w x L + v x P] = tau + drag + restoring
//   drag_i = d_i nu_i + d_ii |nu_i| nu_i,  restoring = [(W-B) down; G x down],  down = R_WB^T e_z.
// Not modelled: products of inertia, off-diagonal added mass, cross-coupled drag, lift.
#include "common/model/regressor.hpp"

#include <cmath>

namespace fathom::model {

BaseRegressor motion_regressor(const Vector6d& nu, const Eigen::Vector3d& down_B) {
  BaseRegressor Y = BaseRegressor::Zero();
  const Eigen::Vector3d v = nu.head<3>();
  const Eigen::Vector3d w = nu.tail<3>();
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3;
    const int k = (i + 2) % 3;
    // P = m_i v_i e_i: w x e_i = w_k e_j - w_j e_k, and v x e_i likewise.
    Y(j, i) = w(k) * v(i);
    Y(k, i) = -w(j) * v(i);
    Y(3 + j, i) = v(k) * v(i);
    Y(3 + k, i) = -v(j) * v(i);
    // L = I_i w_i e_i.
    Y(3 + j, 3 + i) = w(k) * w(i);
    Y(3 + k, 3 + i) = -w(j) * w(i);
  }
  for (int i = 0; i < 6; ++i) {
    Y(i, index(BaseParameter::X_u) + i) = -nu(i);
    Y(i, index(BaseParameter::X_uu) + i) = -std::abs(nu(i)) * nu(i);
  }
  Y.block<3, 1>(0, index(BaseParameter::W_B)) = -down_B;
  // -(G x down) = skew(down) G.
  Y.block<3, 3>(3, index(BaseParameter::G_x)) = skew(down_B);
  return Y;
}

BaseRegressor base_regressor(const Vector6d& nu_dot, const Vector6d& nu, const Eigen::Matrix3d& R_WB) {
  BaseRegressor Y = motion_regressor(nu, R_WB.row(2).transpose());
  for (int i = 0; i < 6; ++i) Y(i, i) += nu_dot(i);
  return Y;
}

}  // namespace fathom::model
