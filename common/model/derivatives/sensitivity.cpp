#include "common/model/derivatives/sensitivity.hpp"

#include <algorithm>
#include <cmath>

#include "common/base/factors.hpp"
#include "common/model/derivatives/state_matrix.hpp"
#include "common/model/regressor.hpp"
#include "common/model/rollout_steps.hpp"

namespace fathom::model {
namespace {

constexpr double kAbsurdDerivative = 1e7;  // (m/s) per kg and the like, all together
constexpr double kDifference = 1e-5;       // m, rad, m/s: truncation and rounding both below 1e-5 of an entry

constexpr double kSteepestSquare = 1e-3;  // cos^2 of the pitch beyond which the heading means nothing

Load total_load(const Model& model, const Motion& motion) {
  Load load;
  load.drag = hull_drag(model, motion.nu_r());
  for (const ActiveEffect& active : model.effects) active.effect->load(motion, active.theta, active.variant, load);
  return load;
}

/// M^-1 of a right-hand side; rows of left-out degrees of freedom become zero.
template <typename Right>
Right divided_by_inertia(const Model& model, const Load& load, Right right) {
  Matrix6d M = load.inertia();
  M.diagonal() += model.theta.head<6>();
  for (Eigen::Index axis = 0; axis < 6; ++axis) {
    if (model.vehicle->dof[static_cast<std::size_t>(axis)]) continue;
    right.row(axis).setZero();
    M.row(axis).setZero();
    M.col(axis).setZero();
    M(axis, axis) = 1.0;
  }
  if (!load.has_couplings) return M.diagonal().cwiseInverse().asDiagonal() * right;
  const InertiaFactor factor{M};
  for (Eigen::Index j = 0; j < right.cols(); ++j) right.col(j) = factor.solve(right.col(j));
  return right;
}

}  // namespace

void Sensitivity::begin(const Model& model, std::size_t samples) {
  place_matters_ = false;
  motion_felt_ = model.motion_matters;
  remembered_.clear();
  for (const ActiveEffect& active : model.effects) {
    place_matters_ = place_matters_ || active.effect->feels_place();
    motion_felt_ = motion_felt_ || active.effect->feels_motion();
    if (!active.effect->remembers_motion()) continue;
    const auto size =
        static_cast<std::size_t>(active.effect->state_size(*model.vehicle, static_cast<int>(model.allocation.cols())));
    remembered_.push_back({&active, size, std::vector<double>(size * kColumns, 0.0)});
  }
  state_.setZero();
  for (Eigen::Index axis = 0; axis < 6; ++axis) {
    if (model.vehicle->dof[static_cast<std::size_t>(axis)]) state_(6 + axis, kBaseParameterCount + axis) = 1.0;
  }
  if (!remembered_.empty()) {
    moving_.clear();
    for (const std::string& name : model.vehicle->parameters) {
      if (const auto parameter = parameter_from_name(name)) moving_.push_back(index(*parameter));
    }
    for (Eigen::Index axis = 0; axis < 6; ++axis) {
      if (model.vehicle->dof[static_cast<std::size_t>(axis)]) moving_.push_back(kBaseParameterCount + axis);
    }
  }
  out_.resize(static_cast<Eigen::Index>(6 * samples), Eigen::NoChange);
  record(0);
}

void Sensitivity::record(std::size_t k) {
  out_.middleRows<6>(static_cast<Eigen::Index>(6 * k)) = state_.bottomRows<6>();
}

Sensitivity::Input Sensitivity::input(const Model& model, const Motion& motion, const Vector6d& nu_dot) const {
  // Y(nu_dot, nu, R) theta = wrench, so d(nu_dot)/d(theta) = -M^-1 Y. Drag and added mass feel the relative velocity;
  // the added mass also its change, since steady water turns in B: nu_c_dot = -w x v_c.
  Vector6d nu_r_dot = nu_dot;
  nu_r_dot.head<3>() += motion.nu.tail<3>().cross(motion.v_WF_B) - motion.a_WF_B;
  BaseRegressor Y = base_regressor(nu_r_dot, motion.nu_r(), motion.R_WB);
  const Load load = total_load(model, motion);
  for (Eigen::Index axis = 0; axis < 3 && load.drag_share != 0.0; ++axis) {
    Y(axis, index(BaseParameter::X_u) + axis) *= 1.0 + load.drag_share;
    Y(axis, index(BaseParameter::X_uu) + axis) *= 1.0 + load.drag_share;
  }
  return divided_by_inertia(model, load, Eigen::Matrix<double, 6, kBaseParameterCount>(-Y));
}

void Sensitivity::velocity_rows(const Model& model, const Motion& motion, const Vector6d& nu_dot, Dynamics& A) const {
  Eigen::Matrix<double, 6, 12> slope = Eigen::Matrix<double, 6, 12>::Zero();
  slope.rightCols<9>() = base_force_slope(model.theta, motion);
  const Load load = total_load(model, motion);
  if (!load.wrench.isZero(0.0) || load.has_inertia()) {
    const auto add = [&](Eigen::Index column, const Motion& moved) {
      const Load there = total_load(model, moved);
      Vector6d change = there.wrench - load.wrench;
      if (load.has_inertia()) change -= (there.inertia() - load.inertia()) * nu_dot;
      slope.col(column) += change / kDifference;
    };
    Motion moved = motion;
    for (Eigen::Index i = 0; i < 3; ++i) {
      if (place_matters_) {
        moved.p_WB[i] += kDifference;
        add(i, moved);
        moved.p_WB = motion.p_WB;
      }
      const Eigen::Vector3d e = kDifference * Eigen::Vector3d::Unit(i);
      moved.R_WB = motion.R_WB * quaternion_from_rotation_vector(e).toRotationMatrix();
      add(3 + i, moved);
      moved.R_WB = motion.R_WB;
    }
    for (Eigen::Index i = 0; i < 6; ++i) {
      moved.nu[i] += kDifference;
      add(6 + i, moved);
      moved.nu[i] = motion.nu[i];
    }
  }
  for (Eigen::Index axis = 0; axis < 6; ++axis) {
    if (!model.vehicle->dof[static_cast<std::size_t>(axis)]) slope.col(6 + axis).setZero();
  }
  A.bottomRows<6>() = divided_by_inertia(model, load, slope);
}

void Sensitivity::velocity_rows_by_differences(Rollout& rollout, const StepMiddle& at, Dynamics& A) const {
  const auto column = [&](Eigen::Index j, const Eigen::Vector3d& p, const Eigen::Quaterniond& q, const Vector6d& nu) {
    A.block<6, 1>(6, j) = (rollout.felt_acceleration(at.from, at.offset, p, q, nu, 0.0) - at.nu_dot) / kDifference;
  };
  for (Eigen::Index i = 0; i < 3; ++i) {
    if (place_matters_) column(i, at.p + kDifference * Eigen::Vector3d::Unit(i), at.q, at.nu);
    column(3 + i, at.p, at.q * quaternion_from_rotation_vector(kDifference * Eigen::Vector3d::Unit(i)), at.nu);
  }
  for (Eigen::Index i = 0; i < 6; ++i) {
    if (rollout.model().vehicle->dof[static_cast<std::size_t>(i)])
      column(6 + i, at.p, at.q, at.nu + kDifference * Vector6d::Unit(i));
  }
}

/// out = A state + B, row by row: most of A's upper half is zero, and position is left out where no effect asks for it.
void Sensitivity::slope(const Dynamics& A, const Input& B, const State& state, State& out) const {
  out.topRows<6>().setZero();
  out.bottomRows<6>().leftCols<kBaseParameterCount>() = B;
  out.bottomRows<6>().rightCols<6>().setZero();
  for (Eigen::Index i = place_matters_ ? 0 : 3; i < 12; ++i) {
    for (Eigen::Index j = place_matters_ ? 0 : 3; j < 12; ++j) {
      if (A(i, j) != 0.0) out.row(i) += A(i, j) * state.row(j);
    }
  }
}

/// How the step's rates of decay move with the parameters and with the velocity at its start.
Eigen::Matrix<double, 6, Sensitivity::kColumns> Sensitivity::decay_rows(const Model& model,
                                                                        const StepMiddle& at) const {
  Eigen::Matrix<double, 6, kColumns> rows = Eigen::Matrix<double, 6, kColumns>::Zero();
  for (Eigen::Index i = 0; i < 6; ++i) {
    const double mass = model.theta[i], speed = at.nu_begin[i];
    if (!(at.decay[i] > 0.0) || !model.vehicle->dof[static_cast<std::size_t>(i)]) continue;
    rows.row(i) =
        -2.0 * model.theta[index(BaseParameter::X_uu) + i] * std::copysign(1.0, speed) / mass * state_.row(6 + i);
    rows(i, i) -= at.decay[i] / mass;
    rows(i, index(BaseParameter::X_u) + i) -= 1.0 / mass;
    rows(i, index(BaseParameter::X_uu) + i) -= 2.0 * std::abs(speed) / mass;
  }
  return rows;
}

/// What is remembered goes on by dt, and `wrenches` is what it changes then. `state` holds at the end of that time.
void Sensitivity::remember(const Motion& motion, const State& state, double dt, Wrenches& wrenches) {
  Motion change;
  change.vehicle = motion.vehicle;
  for (const Eigen::Index column : moving_) {
    change.nu = state.block<6, 1>(6, column);
    // Water that moves in W turns in B the other way.
    change.nu.head<3>() += state.block<3, 1>(3, column).cross(motion.v_WF_B);
    change.w_memory.setZero();
    for (Remembered& memory : remembered_) {
      const ActiveEffect& active = *memory.active;
      const std::span<double> z{memory.z.data() + static_cast<std::size_t>(column) * memory.size, memory.size};
      active.effect->advance(change, active.theta, active.variant, dt, z);
      active.effect->feel(change, active.theta, active.variant, z);
    }
    wrenches.col(column) = change.w_memory;
  }
}

void Sensitivity::advance(Rollout& rollout, const StepMiddle& at, double h) {
  const Model& model = rollout.model();
  const Motion motion = rollout.motion();
  const Eigen::Matrix3d& R_WB = motion.R_WB;
  Dynamics A = Dynamics::Zero();
  A.block<3, 3>(0, 3) = -R_WB * skew(at.nu.head<3>());
  A.block<3, 3>(0, 6) = R_WB;
  A.block<3, 3>(3, 3) = -skew(at.nu.tail<3>());
  A.block<3, 3>(3, 9).setIdentity();
  const Input B = input(model, motion, at.nu_dot);
  if (motion_felt_) {
    velocity_rows_by_differences(rollout, at, A);
  } else {
    velocity_rows(model, motion, at.nu_dot, A);
  }

  // The rollout's own rule: velocity rows decay exactly, at rates that move too; the others take the plain midpoint.
  const double half = 0.5 * h;
  const auto decay = decay_rows(model, at);
  State rate, middle;
  slope(A, B, state_, rate);
  Wrenches wrenches;
  if (!remembered_.empty()) {
    wrenches.setZero();
    remember(motion, state_, half, wrenches);
    rate.bottomRows<6>() += divided_by_inertia(model, total_load(model, motion), wrenches);
  }
  middle = half * rate;
  middle.bottomRows<6>() = at.shares.half.asDiagonal() * middle.bottomRows<6>();
  middle.bottomRows<6>() += (half * half * at.shares.half_slope).cwiseProduct(at.nu_dot_begin).asDiagonal() * decay;
  State rate_middle;
  slope(A, B, state_ + middle, rate_middle);
  if (!remembered_.empty()) {
    remember(motion, state_ + middle, half, wrenches);
    rate_middle.bottomRows<6>() += divided_by_inertia(model, total_load(model, motion), wrenches);
  }
  state_.topRows<6>() += h * rate_middle.topRows<6>();
  const Vector6d moved = at.nu - at.nu_begin;
  const Vector6d change = at.nu_dot + at.decay.cwiseProduct(moved) - at.nu_dot_begin;
  const Vector6d by_decay =
      h * (at.shares.whole_slope.cwiseProduct(at.nu_dot_begin) + 2.0 * at.shares.growth_slope.cwiseProduct(change));
  const Vector6d growth = 2.0 * at.shares.growth;
  state_.bottomRows<6>() += h * ((at.shares.whole - growth).asDiagonal() * rate.bottomRows<6>() +
                                 growth.asDiagonal() * rate_middle.bottomRows<6>() +
                                 growth.cwiseProduct(at.decay).asDiagonal() * middle.bottomRows<6>() +
                                 (by_decay + growth.cwiseProduct(moved)).asDiagonal() * decay);

  // A trajectory that diverges has no useful derivative; the solver will turn back from it.
  if (!(state_.squaredNorm() < kAbsurdDerivative * kAbsurdDerivative)) {
    state_.setZero();
    for (Remembered& memory : remembered_) std::ranges::fill(memory.z, 0.0);
  }

  // Attitude that follows the measurement does not move with the parameters. A small rotation e in B turns the heading
  // (Euler's psi) by (down_y e_y + down_z e_z) / cos^2 theta; the rest of it is tilt.
  if (!rollout.tilt_measured() && !rollout.heading_measured()) return;
  const Eigen::Vector3d down_B = R_WB.row(2).transpose();
  const Eigen::Vector3d across{0.0, down_B.y(), down_B.z()};
  const Eigen::RowVector3d turn = across.transpose() / std::max(across.squaredNorm(), kSteepestSquare);
  auto rotation = state_.middleRows<3>(3);
  if (rollout.tilt_measured() && rollout.heading_measured()) {
    rotation.setZero();
  } else if (rollout.tilt_measured()) {
    rotation = (down_B * (turn * rotation)).eval();
  } else {
    rotation -= (down_B * (turn * rotation)).eval();
  }
}

}  // namespace fathom::model
