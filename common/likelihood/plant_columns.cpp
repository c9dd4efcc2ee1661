// Slopes of a plant's acceleration with the velocity and with every free number.
#include <algorithm>
#include <cmath>

#include "common/likelihood/plant.hpp"

namespace fathom::likelihood {
namespace {

constexpr double kVelocityStep = 1e-5;  // m/s, rad/s, m/s^2: truncation and rounding both below 1e-5 of a slope

}  // namespace

Matrix6d Plant::slope(const Vector6d& nu, const Vector6d& nu_dot) {
  Matrix6d slope = Matrix6d::Zero();
  Vector6d moved = nu;
  for (Eigen::Index i = 0; i < 6; ++i) {
    if (!model_.vehicle->dof[static_cast<std::size_t>(i)]) continue;
    moved[i] += kVelocityStep;
    slope.col(i) = (acceleration(moved) - nu_dot) / kVelocityStep;
    moved[i] = nu[i];
  }
  return slope;
}

Matrix6d Plant::inverse_inertia(const Vector6d& nu, const Vector6d& nu_dot) {
  Matrix6d inverse = Matrix6d::Zero();
  feel_at(nu);
  const Vector6d remembered = motion_.w_memory + outside_wrench();
  for (Eigen::Index i = 0; i < 6; ++i) {
    if (!model_.vehicle->dof[static_cast<std::size_t>(i)]) continue;
    motion_.w_memory = remembered + Vector6d::Unit(i);
    inverse.col(i) = model::acceleration(model_, motion_) - nu_dot;
  }
  motion_.w_memory = remembered;
  return inverse;
}

void Plant::columns(std::size_t block, const Vector6d& nu, const Vector6d& nu_dot, Columns& out) {
  const auto b = static_cast<Eigen::Index>(block);
  const Matrix6d inverse = inverse_inertia(nu, nu_dot);
  features_.nu = motion_.nu_r();
  features_.by_mass = model::held_back_by_mass(nu_dot, nu);
  if (free_drags_) features_.drag = model::hull_drag(model_, features_.nu);
  const Vector6d past = features_.nu, drag = features_.drag;  // as the columns before do not leave them
  for (std::size_t j = 0; j < numbers_.size(); ++j) {
    const auto column = static_cast<Eigen::Index>(j);
    const Number& number = numbers_[j];
    if (slope_of_[j] >= 0) {
      const Eigen::VectorXd slope = slopes_[static_cast<std::size_t>(slope_of_[j])].col(b);
      if (!feels_) {
        out.col(column) = inverse * (model_.allocation * slope);
      } else {  // hull effects read the thrust too; over a step that changes it by a newton at most
        const double size = 1.0 / std::max(slope.cwiseAbs().maxCoeff(), 1e-9);
        const model::ActuatorForces before = force_;
        force_ += size * slope;
        out.col(column) = (acceleration(nu) - nu_dot) / size;
        force_ = before;
      }
      continue;
    }
    switch (number.kind) {
      case NumberKind::kBase: {
        double& there = model_.theta[number.index];
        const double before = there;
        there += number.step;
        out.col(column) = (acceleration(nu) - nu_dot) / number.step;
        there = before;
        break;
      }
      case NumberKind::kEffect: {
        const auto e = static_cast<std::size_t>(number.index);
        const Vector6d* remembered = memory_.slope(j);
        const Stage stage = stages_[e];
        if (remembered != nullptr) {
          out.col(column) = inverse * *remembered;
        } else if (stage != Stage::kHull) {
          out.col(column).setZero();
        } else {
          double& there = model_.effects[e].theta[static_cast<std::size_t>(number.component)];
          const double before = there;
          there += number.step;
          out.col(column) = (acceleration(nu) - nu_dot) / number.step;
          there = before;
        }
        break;
      }
      case NumberKind::kWeight: {
        const Feature& feature = free_.features[static_cast<std::size_t>(number.index)];
        features_.nu = past;
        features_.drag = drag;
        if (feature.streams()) {
          const double value = feature.value(features_), rate = feature.rate(features_);
          const double size = std::abs(value) + std::abs(rate);
          out.col(column).setZero();
          if (size == 0.0) break;
          const Eigen::Vector3d v = v_WF_B_, a = a_WF_B_;
          const Eigen::Vector3d step =
              kVelocityStep / size * motion_.R_WB.row(feature.axis - model::kStream).transpose();
          v_WF_B_ += value * step;
          a_WF_B_ += rate * step;
          out.col(column) = (acceleration(nu) - nu_dot) * (size / kVelocityStep);
          v_WF_B_ = v;
          a_WF_B_ = a;
          break;
        }
        Vector6d wrench = Vector6d::Zero();
        feature.add(features_, 1.0, wrench);
        out.col(column) = inverse * wrench;
        break;
      }
      case NumberKind::kWorldForce:
        out.col(column).setZero();
        if (number.run == static_cast<int>(run_index_))
          out.col(column) = inverse.leftCols<3>() * motion_.R_WB.row(number.index).transpose();
        break;
      default:
        out.col(column).setZero();
    }
  }
}

void Plant::remember_columns(std::size_t block, const Columns& nu_columns, Columns& wrenches) {
  wrenches.setZero();
  if (!memory_.empty()) memory_.advance_columns(motion_, run_.blocks()[block].dt, nu_columns, wrenches);
}

}  // namespace fathom::likelihood
