#include "common/model/dynamics.hpp"

#include <algorithm>
#include <array>

#include "common/base/factors.hpp"
#include "common/model/actuators.hpp"
#include "common/model/hull_terms.hpp"

namespace fathom::model {
namespace {

constexpr double kUnknownRigidShare =
    0.5;  // of the lumped mass, when the vehicle file does not say: added mass of a blunt hull

/// Where the effect stands in the chain.
std::ptrdiff_t rank(const ActiveEffect& active) {
  const auto all = all_effects();
  const std::ptrdiff_t place = std::ranges::find(all, active.effect) - all.begin();
  return changes_thrust(*active.effect) ? place : place + 1;
}

int actuators(const Model& model) { return static_cast<int>(model.allocation.cols()); }

Vector6d inertia_diagonal(const Model& model) { return model.theta.head<6>(); }

/// By actuators and by what effects remember.
Vector6d pushed(const Model& model, const Motion& motion) {
  Vector6d force = motion.w_memory;  // column by column: six rows at a time are quicker than a product of unknown size
  if (model.motion_matters) {
    for (Eigen::Index i = 0; i < motion.force.size(); ++i) force += acting_wrench(*model.vehicle, motion, i);
    return force;
  }
  for (Eigen::Index i = 0; i < motion.force.size(); ++i) force += model.allocation.col(i) * motion.force[i];
  return force;
}

}  // namespace

void Model::add(ActiveEffect effect) {
  const auto place =
      std::ranges::upper_bound(effects, rank(effect), {}, [](const ActiveEffect& active) { return rank(active); });
  effects.insert(place, std::move(effect));
}

int Model::memory_size() const {
  int size = 0;
  for (const ActiveEffect& active : effects) size += active.effect->state_size(*vehicle, actuators(*this));
  return size;
}

Model nominal_model(const Vehicle& vehicle, bool input_is_wrench) {
  Model model{.vehicle = &vehicle};
  if (input_is_wrench || vehicle.thrusters.empty()) {
    model.allocation = Matrix6d::Identity();
  } else {
    model.allocation = vehicle.allocation;
    model.motion_matters = vehicle.flow_matters || vehicle.weight_moves;
  }
  for (std::size_t i = 0; i < vehicle.parameters.size(); ++i) {
    if (const auto parameter = parameter_from_name(vehicle.parameters[i])) {
      model.theta[index(*parameter)] = vehicle.priors[i].mean;
    }
  }
  return model;
}

void feel(const Model& model, Motion& motion, std::span<double> memory, double dt) {
  std::size_t offset = 0;
  for (const ActiveEffect& active : model.effects) {
    const auto size = static_cast<std::size_t>(active.effect->state_size(*model.vehicle, actuators(model)));
    const std::span<double> z = memory.subspan(offset, size);
    if (dt > 0.0 && size > 0) active.effect->advance(motion, active.theta, active.variant, dt, z);
    active.effect->feel(motion, active.theta, active.variant, z);
    offset += size;
  }
}

void settle(const Model& model, Motion motion, std::span<double> memory) {
  std::size_t offset = 0;
  for (const ActiveEffect& active : model.effects) {
    const auto size = static_cast<std::size_t>(active.effect->state_size(*model.vehicle, actuators(model)));
    const std::span<double> z = memory.subspan(offset, size);
    active.effect->settle(motion, active.theta, active.variant, z);
    active.effect->feel(motion, active.theta, active.variant, z);
    offset += size;
  }
}

Vector6d hull_drag(const Model& model, const Vector6d& nu_r) {
  return model.theta.segment<6>(index(BaseParameter::X_u)).cwiseProduct(nu_r) +
         model.theta.segment<6>(index(BaseParameter::X_uu)).cwiseProduct(nu_r.cwiseAbs().cwiseProduct(nu_r));
}

// Kirchhoff: C(nu) nu = [w x P; w x L + v x P] with momenta P, L (Fossen 2011, eq. 6.44 for diagonal M).
HullTerms::HullTerms(const Model& model, const Motion& motion) : drag{hull_drag(model, motion.nu)} {
  const auto& theta = model.theta;
  const Vector6d inertia = inertia_diagonal(model);
  const Eigen::Vector3d v = motion.nu.head<3>();
  const Eigen::Vector3d w = motion.nu.tail<3>();
  const Eigen::Vector3d momentum = inertia.head<3>().cwiseProduct(v);
  const Eigen::Vector3d angular = inertia.tail<3>().cwiseProduct(w);
  coriolis.head<3>() = w.cross(momentum);
  coriolis.tail<3>() = w.cross(angular) + v.cross(momentum);
  const Eigen::Vector3d down_B = motion.R_WB.row(2).transpose();
  restoring.head<3>() = theta[index(BaseParameter::W_B)] * down_B;
  restoring.tail<3>() = theta.segment<3>(index(BaseParameter::G_x)).cross(down_B);
}

Vector6d generalised_force(const Model& model, const Motion& motion, const HullTerms& hull, Load& load) {
  Vector6d force = pushed(model, motion) - hull.coriolis;
  load.clear();
  load.drag = hull.drag;
  force += load.drag;
  force += hull.restoring;
  for (const ActiveEffect& active : model.effects) active.effect->load(motion, active.theta, active.variant, load);
  return force + load.wrench;
}

Vector6d generalised_force(const Model& model, const Motion& motion, Load& load) {
  if (!water_moves(motion)) return generalised_force(model, motion, HullTerms{model, motion}, load);
  const auto& theta = model.theta;
  const Vector6d inertia = inertia_diagonal(model);
  const Vector6d nu_r = motion.nu_r();
  const Eigen::Vector3d v = motion.nu.head<3>();
  const Eigen::Vector3d w = motion.nu.tail<3>();
  Vector6d force = pushed(model, motion);

  // The rigid share weighs the same along every axis, so that v x m v = 0: still water is not needed for rest.
  const double stated = model.vehicle->mass;
  const double mass = stated > 0.0 ? stated : kUnknownRigidShare * inertia.head<3>().mean();
  const Eigen::Vector3d added = inertia.head<3>() - Eigen::Vector3d::Constant(mass);
  const Eigen::Vector3d v_r = nu_r.head<3>();
  const Eigen::Vector3d momentum_r = added.cwiseProduct(v_r);
  const Eigen::Vector3d momentum = mass * v;
  const Eigen::Vector3d angular = inertia.tail<3>().cwiseProduct(w);
  // Steady water in W: its velocity seen in B turns with the body, nu_c_dot = -w x v_c.
  force.head<3>() -= w.cross(momentum + momentum_r) + added.cwiseProduct(w.cross(motion.v_WF_B));
  force.tail<3>() -= w.cross(angular) + v_r.cross(momentum_r);
  // Accelerating water drags the added mass along, and its pressure gradient pushes the displaced water's share
  // (Froude-Krylov), which for a vehicle near neutral buoyancy weighs as much as the vehicle: m + A in all.
  force.head<3>() += inertia.head<3>().cwiseProduct(motion.a_WF_B);

  load.clear();
  load.drag = hull_drag(model, nu_r);
  force += load.drag;

  const Eigen::Vector3d down_B = motion.R_WB.row(2).transpose();
  force.head<3>() += theta[index(BaseParameter::W_B)] * down_B;
  force.tail<3>() += theta.segment<3>(index(BaseParameter::G_x)).cross(down_B);

  for (const ActiveEffect& active : model.effects) active.effect->load(motion, active.theta, active.variant, load);
  return force + load.wrench;
}

Vector6d acceleration(const Model& model, const Motion& motion) {
  Load load;
  Vector6d force = generalised_force(model, motion, load);
  if (motion.m_more != 0.0) {
    const Vector6d before = load.wrench;
    load.add_mass(motion.m_more, motion.nu);
    force += load.wrench - before;
  }
  const Vector6d inertia = inertia_diagonal(model);
  const auto& dof = model.vehicle->dof;
  Vector6d nu_dot = Vector6d::Zero();
  if (!load.has_couplings) {
    for (Eigen::Index i = 0; i < 6; ++i) {
      if (dof[static_cast<std::size_t>(i)]) nu_dot[i] = force[i] / (inertia[i] + load.inertia_diagonal[i]);
    }
    return nu_dot;
  }
  Matrix6d M = load.inertia();
  M.diagonal() += inertia;
  Vector6d right = force - M * motion.nu_dot_told;
  for (Eigen::Index i = 0; i < 6; ++i) {
    if (dof[static_cast<std::size_t>(i)]) continue;
    M.row(i).setZero();
    M.col(i).setZero();
    M(i, i) = 1.0;
    right[i] = 0.0;
  }
  return InertiaFactor{M}.solve(right);
}

Vector6d residual_wrench(const Model& model, const Motion& motion, const Vector6d& nu_dot) {
  Load load;
  const Vector6d force = generalised_force(model, motion, load);
  Vector6d inertial = inertia_diagonal(model).cwiseProduct(nu_dot);
  if (load.has_inertia()) inertial += load.inertia() * nu_dot;
  return inertial - force;
}

}  // namespace fathom::model
