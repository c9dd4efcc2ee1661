#include "common/model/sensitivity.hpp"

#include <Eigen/LU>
#include <algorithm>

#include "common/model/regressor.hpp"
#include "common/model/rollout_steps.hpp"

namespace fathom::model {
namespace {

constexpr double kAbsurdDerivative = 1e6;  // (m/s) per kg and the like
constexpr double kDifference = 1e-5;       // m, rad, m/s: truncation and rounding both below 1e-5 of an entry

constexpr double kSteepest = 1e-3;  // cos^2 of the pitch beyond which the heading means nothing

}  // namespace

void Sensitivity::begin(const Vehicle& vehicle, std::size_t samples) {
  state_.setZero();
  for (Eigen::Index axis = 0; axis < 6; ++axis) {
    if (vehicle.dof[static_cast<std::size_t>(axis)]) state_(6 + axis, kBaseParameterCount + axis) = 1.0;
  }
  out_.resize(static_cast<Eigen::Index>(6 * samples), Eigen::NoChange);
  record(0);
}

void Sensitivity::record(std::size_t k) {
  out_.middleRows<6>(static_cast<Eigen::Index>(6 * k)) = state_.bottomRows<6>();
}

Eigen::Matrix<double, 6, kBaseParameterCount> Sensitivity::input(Rollout& rollout, std::size_t from, double offset,
                                                                 const Eigen::Vector3d& p, const Eigen::Quaterniond& q,
                                                                 const Vector6d& nu, const Vector6d& nu_dot) const {
  // Y(nu_dot, nu, R) theta = wrench, so d(nu_dot)/d(theta) = -M^-1 Y. Drag and added mass feel the relative velocity;
  // the added mass also its change, since steady water turns in B: nu_c_dot = -w x v_c.
  const Model& model = rollout.model();
  rollout.felt_acceleration(from, offset, p, q, nu, 0.0);
  const Motion& motion = rollout.motion();
  const Vector6d nu_r = motion.nu_r();
  Vector6d nu_r_dot = nu_dot;
  nu_r_dot.head<3>() += nu.tail<3>().cross(motion.v_WF_B);
  Eigen::Matrix<double, 6, kBaseParameterCount> Y = base_regressor(nu_r_dot, nu_r, motion.R_WB);
  Load load;
  for (const ActiveEffect& active : model.effects) active.effect->load(motion, active.theta, active.variant, load);
  Matrix6d M = load.inertia;
  M.diagonal() += model.theta.head<6>();
  for (Eigen::Index axis = 0; axis < 6; ++axis) {
    if (model.vehicle->dof[static_cast<std::size_t>(axis)]) continue;
    Y.row(axis).setZero();
    M.row(axis).setZero();
    M.col(axis).setZero();
    M(axis, axis) = 1.0;
  }
  if (!load.has_inertia) return -(M.diagonal().cwiseInverse().asDiagonal() * Y);
  return -M.partialPivLu().solve(Y);
}

void Sensitivity::advance(Rollout& rollout, std::size_t from, double offset, const Eigen::Vector3d& p,
                          const Eigen::Quaterniond& q, const Vector6d& nu, const Vector6d& nu_dot,
                          const Vector6d& decay, double h) {
  const Model& model = rollout.model();
  const auto& dof = model.vehicle->dof;
  const Eigen::Matrix3d R_WB = q.toRotationMatrix();
  const Eigen::Vector3d v = nu.head<3>();
  const Eigen::Vector3d w = nu.tail<3>();
  Dynamics A = Dynamics::Zero();
  A.block<3, 3>(0, 3) = -R_WB * skew(v);
  A.block<3, 3>(0, 6) = R_WB;
  A.block<3, 3>(3, 3) = -skew(w);
  A.block<3, 3>(3, 9).setIdentity();

  bool place_matters = false;
  for (const ActiveEffect& active : model.effects) place_matters = place_matters || active.effect->feels_place();
  const auto column = [&](Eigen::Index j, const Eigen::Vector3d& p_moved, const Eigen::Quaterniond& q_moved,
                          const Vector6d& nu_moved) {
    A.block<6, 1>(6, j) =
        (rollout.felt_acceleration(from, offset, p_moved, q_moved, nu_moved, 0.0) - nu_dot) / kDifference;
  };
  for (Eigen::Index i = 0; i < 3; ++i) {
    if (place_matters) column(i, p + kDifference * Eigen::Vector3d::Unit(i), q, nu);
    column(3 + i, p, q * quaternion_from_rotation_vector(kDifference * Eigen::Vector3d::Unit(i)), nu);
  }
  for (Eigen::Index i = 0; i < 6; ++i) {
    if (dof[static_cast<std::size_t>(i)]) column(6 + i, p, q, nu + kDifference * Vector6d::Unit(i));
  }

  State B = State::Zero();
  B.block<6, kBaseParameterCount>(6, 0) = input(rollout, from, offset, p, q, nu, nu_dot);
  // The rollout's own rule: velocity rows decay exactly, the others take the plain midpoint.
  Eigen::Matrix<double, 12, 1> rate = Eigen::Matrix<double, 12, 1>::Zero(), whole, half;
  rate.tail<6>() = decay;
  whole << Vector6d::Ones(), decay_share(h * decay);
  half << Vector6d::Ones(), decay_share(0.5 * h * decay);
  const State middle = 0.5 * h * (half.asDiagonal() * (A * state_ + B));
  state_ += h * (whole.asDiagonal() * (A * (state_ + middle) + B + rate.asDiagonal() * middle));

  // A trajectory that diverges has no useful derivative; the solver will turn back from it.
  if (!state_.allFinite() || state_.cwiseAbs().maxCoeff() > kAbsurdDerivative) state_.setZero();

  // Attitude that follows the measurement does not move with the parameters. A small rotation e in B turns the heading
  // (Euler's psi) by (down_y e_y + down_z e_z) / cos^2 theta; the rest of it is tilt.
  const Eigen::Vector3d down_B = R_WB.row(2).transpose();
  const Eigen::Vector3d across{0.0, down_B.y(), down_B.z()};
  const Eigen::RowVector3d turn = across.transpose() / std::max(across.squaredNorm(), kSteepest);
  auto rotation = state_.middleRows<3>(3);
  if (rollout.tilt_measured() && rollout.heading_measured()) {
    rotation.setZero();
  } else if (rollout.tilt_measured()) {
    rotation = (down_B * (turn * rotation)).eval();
  } else if (rollout.heading_measured()) {
    rotation -= (down_B * (turn * rotation)).eval();
  }
}

}  // namespace fathom::model
