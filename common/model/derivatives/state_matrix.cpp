// With P = M v, L = I w (dynamics.cpp): d(-w x P) = skew(P) dw - skew(w) M dv, and likewise for the moments;
// down_B = R_WB^T e_z turns by skew(down_B) e.
#include "common/model/derivatives/state_matrix.hpp"

namespace fathom::model {

Eigen::Matrix<double, 6, 9> base_force_slope(const BaseTheta& theta, const Motion& motion) {
  const Eigen::Vector3d v = motion.nu.head<3>();
  const Eigen::Vector3d w = motion.nu.tail<3>();
  const Eigen::Vector3d mass = theta.head<3>();
  const Eigen::Vector3d inertia = theta.segment<3>(3);
  const Eigen::Matrix3d skew_P = skew(mass.cwiseProduct(v));
  const Eigen::Matrix3d skew_down = skew(motion.R_WB.row(2).transpose());
  Eigen::Matrix<double, 6, 9> slope;
  slope.block<3, 3>(0, 0) = theta[index(BaseParameter::W_B)] * skew_down;
  slope.block<3, 3>(3, 0) = skew(theta.segment<3>(index(BaseParameter::G_x))) * skew_down;
  slope.block<3, 3>(0, 3) = -skew(w) * mass.asDiagonal();
  slope.block<3, 3>(0, 6) = skew_P;
  slope.block<3, 3>(3, 3) = skew_P - skew(v) * mass.asDiagonal();
  slope.block<3, 3>(3, 6) = skew(inertia.cwiseProduct(w)) - skew(w) * inertia.asDiagonal();
  slope.rightCols<6>().diagonal() +=
      theta.segment<6>(index(BaseParameter::X_u)) +
      2.0 * theta.segment<6>(index(BaseParameter::X_uu)).cwiseProduct(motion.nu.cwiseAbs());
  return slope;
}

}  // namespace fathom::model
