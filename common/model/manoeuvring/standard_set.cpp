#include "common/model/manoeuvring/standard_set.hpp"

#include <algorithm>
#include <cmath>

#include "common/model/actuators.hpp"
#include "common/model/derivative_motion.hpp"
#include "common/model/motion.hpp"
#include "common/model/vehicle.hpp"

namespace fathom::model {

#define STANDARD_SET(name) const StandardSet& name();
#include "common/model/manoeuvring/standard_sets.def"
#undef STANDARD_SET

namespace {

constexpr double kStands = 0.7;  // of a unit axis: more along it than across

/// 1: a rudder, 2: a plane; 0: neither.
Eigen::Index stands(const Thruster& one) {
  if (!one.fin) return 0;
  if (std::abs(one.axis_B.y()) > kStands) return 1;
  return std::abs(one.axis_B.z()) > kStands ? 2 : 0;
}

bool among(const Hydrodynamics& h, Eigen::Index axis) {
  return std::ranges::any_of(h.coefficients, [&](const ManoeuvringCoefficient& one) {
    if (!one.term->steers) return false;
    const bool level = one.term->axis == 0 || one.term->axis == 1 || one.term->axis == 5;
    return axis == 1 ? level : one.term->axis == 2 || one.term->axis == 4;
  });
}

/// C nu of a momentum [N, N m]: w x P, w x L + v x P.
Vector6d coriolis(const Vector6d& nu, const Vector6d& momentum) {
  const Eigen::Vector3d v = nu.head<3>(), w = nu.tail<3>(), P = momentum.head<3>(), L = momentum.tail<3>();
  Vector6d both;
  both << w.cross(P), w.cross(L) + v.cross(P);
  return both;
}

}  // namespace

const ManoeuvringTerm* StandardSet::find(std::string_view term) const {
  const auto found = std::ranges::find(terms, term, &ManoeuvringTerm::name);
  return found == terms.end() ? nullptr : &*found;
}

std::span<const StandardSet* const> standard_sets() {
  static const std::array all{
#define STANDARD_SET(name) &name(),
#include "common/model/manoeuvring/standard_sets.def"
#undef STANDARD_SET
  };
  return all;
}

const StandardSet* find_standard_set(std::string_view name) {
  const auto all = standard_sets();
  const auto found = std::ranges::find(all, name, &StandardSet::name);
  return found == all.end() ? nullptr : *found;
}

std::string standard_set_names() {
  std::string names;
  for (const StandardSet* set : standard_sets()) names += (names.empty() ? "" : ", ") + std::string{set->name};
  return names;
}

TermMotion term_motion(const Vehicle& vehicle, const Motion& motion) {
  TermMotion seen{motion.nu_r()};
  seen.cruise = vehicle.hydrodynamics->cruise;
  if (motion.force.size() != static_cast<Eigen::Index>(vehicle.thrusters.size())) return seen;
  std::array<double, 3> sum{}, count{};
  for (std::size_t i = 0; i < vehicle.thrusters.size(); ++i) {
    const Thruster& one = vehicle.thrusters[i];
    const Eigen::Index axis = stands(one);
    if (axis == 0) continue;
    const double angle = motion.force[static_cast<Eigen::Index>(i)] / one.fin->slope;
    const double positive = axis == 1 ? one.axis_B.y() : -one.axis_B.z();
    sum[static_cast<std::size_t>(axis)] += positive > 0.0 ? angle : -angle;
    count[static_cast<std::size_t>(axis)] += 1.0;
  }
  if (count[1] > 0.0) seen.rudder = sum[1] / count[1];
  if (count[2] > 0.0) seen.plane = sum[2] / count[2];
  return seen;
}

Vector6d by_coefficients(const Vehicle& vehicle, const Motion& motion) {
  const Hydrodynamics& h = *vehicle.hydrodynamics;
  return manoeuvring_wrench(h.coefficients, term_motion(vehicle, motion), h.lengths(vehicle.water_density));
}

Vector6d added_coriolis(const Vehicle& vehicle, const Motion& motion) {
  const Hydrodynamics& h = *vehicle.hydrodynamics;
  Vector6d wrench = Vector6d::Zero();
  if (h.set->coriolis == AddedCoriolis::kAmongTerms) return wrench;
  const Vector6d nu_r = motion.nu_r();
  const Vector6d all = coriolis(nu_r, h.added_mass * nu_r);
  wrench.head<3>() = -all.head<3>();
  if (h.set->coriolis == AddedCoriolis::kWhole) wrench.tail<3>() = -all.tail<3>();
  return wrench;
}

Vector6d hull_wrench(const Vehicle& vehicle, const Motion& motion) {
  return by_coefficients(vehicle, motion) + added_coriolis(vehicle, motion);
}

Vector6d beside_base(const Vehicle& vehicle, const Motion& motion) {
  const Hydrodynamics& h = *vehicle.hydrodynamics;
  const TermLengths lengths = h.lengths(vehicle.water_density);
  const Vector6d nu_r = motion.nu_r();
  Vector6d wrench = by_coefficients(vehicle, motion);
  for (Eigen::Index i = h.set->needs_cruise ? 1 : 0; i < 6; ++i) {
    TermMotion alone{nu_r[i] * Vector6d::Unit(i)};
    alone.cruise = h.cruise;
    wrench[i] -= manoeuvring_wrench(h.coefficients, alone, lengths)[i];
  }
  if (h.set->coriolis != AddedCoriolis::kWhole) {
    const Vector6d added = coriolis(nu_r, h.added_mass * nu_r);
    wrench.tail<3>() += added.tail<3>();
    if (h.set->coriolis == AddedCoriolis::kAmongTerms) wrench.head<3>() += added.head<3>();
  }
  if (!h.rigid_coriolis) wrench += coriolis(motion.nu, rigid_inertia(vehicle) * motion.nu);
  if (!vehicle.thrusters.empty() && motion.force.size() == static_cast<Eigen::Index>(vehicle.thrusters.size()))
    wrench += h.set->pushed(vehicle, motion) - acting_wrench(vehicle, motion);
  return wrench;
}

Vector6d pushed_but_for_steering(const Vehicle& vehicle, const Motion& motion) {
  const Hydrodynamics& h = *vehicle.hydrodynamics;
  const std::array<bool, 3> told{false, among(h, 1), among(h, 2)};
  Vector6d sum = Vector6d::Zero();
  for (Eigen::Index i = 0; i < motion.force.size(); ++i) {
    const Eigen::Index axis = stands(vehicle.thrusters[static_cast<std::size_t>(i)]);
    if (axis == 0 || !told[static_cast<std::size_t>(axis)]) sum += acting_wrench(vehicle, motion, i);
  }
  return sum;
}

}  // namespace fathom::model
