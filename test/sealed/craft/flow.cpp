#include "test/sealed/craft/flow.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace fathom::sealed {
namespace {

using Eigen::Vector3d;

constexpr double kProfileDrag = 0.012;  // of a foil section (Hoerner 1965)
constexpr double kOswald = 0.85;        // how far from elliptic its loading is

Vector6 at(const Vector3d& position, const Vector3d& force) {
  Vector6 wrench;
  wrench << force, position.cross(force);
  return wrench;
}

Vector3d speed_at(const Vector6& nu_r, const Vector3d& position) {
  return nu_r.head<3>() + Vector3d(nu_r.tail<3>()).cross(position);
}

/// u |u| of the water past a fin [m^2/s^2]: momentum theory's jet of the propeller before it comes on top.
double wash(const Craft& craft, const Jet& fin, const Eigen::VectorXd& acting, const Vector6& nu_r) {
  const double u = speed_at(nu_r, fin.position).x();
  double square = u * std::abs(u);
  if (fin.behind >= 0) {
    const double disc = 0.25 * std::numbers::pi * fin.diameter * fin.diameter;
    square += fin.share * 2.0 * std::max(acting[fin.behind], 0.0) / (craft.density * disc);
  }
  return square;
}

/// Lift square to the flow and drag along it (Fossen 2021, sec. 9.7): linear as far as the stall, held beyond.
Vector3d foil_force(double density, const Foil& foil, double deflection, double along, double across) {
  const double square = along * along + across * across, speed = std::sqrt(square);
  if (speed < 1e-9) return Vector3d::Zero();
  const double drift = std::atan2(across, std::abs(along)) * (along < 0.0 ? -1.0 : 1.0);
  const double lift = foil.slope * std::clamp(deflection - drift, -foil.stall, foil.stall);
  const double drag = kProfileDrag + lift * lift / (std::numbers::pi * kOswald * foil.aspect);
  const double pressure = 0.5 * density * foil.area * square;
  const double ahead = pressure * (-lift * across - drag * along) / speed;
  const double aside = pressure * (lift * along - drag * across) / speed;
  return foil.upright ? Vector3d(ahead, aside, 0.0) : Vector3d(ahead, 0.0, aside);
}

double fin_unit(const Craft& craft, const Jet& fin) {
  return 0.5 * craft.density * fin.area * fin.slope * fin.reference * fin.reference;
}

}  // namespace

Eigen::VectorXd acting_forces(const Craft& craft, const Eigen::VectorXd& told, const Vector6& nu_r) {
  Eigen::VectorXd acting = told;
  for (std::size_t i = 0; i < craft.jets.size(); ++i) {
    const Jet& jet = craft.jets[i];
    if (jet.drive != Drive::kPropeller) continue;
    // T = rho D^4 K_T0 n |n| + rho D^3 K_T1 |n| u_a (Fossen 2021, sec. 9.1).
    double& force = acting[static_cast<Eigen::Index>(i)];
    const double turns = std::sqrt(std::abs(force) / (craft.density * std::pow(jet.diameter, 4) * jet.thrust_0));
    const double advance = jet.axis.dot(speed_at(nu_r, jet.position));
    force += craft.density * std::pow(jet.diameter, 3) * jet.thrust_1 * turns * advance;
  }
  for (std::size_t i = 0; i < craft.jets.size(); ++i) {
    const Jet& jet = craft.jets[i];
    if (jet.drive != Drive::kFin) continue;
    acting[static_cast<Eigen::Index>(i)] *= wash(craft, jet, acting, nu_r) / (jet.reference * jet.reference);
  }
  return acting;
}

Vector6 push_of(const Craft& craft, const Eigen::VectorXd& acting, const Vector3d& down) {
  Vector6 sum = Vector6::Zero();
  for (std::size_t i = 0; i < craft.jets.size(); ++i) {
    const Jet& jet = craft.jets[i];
    const double force = acting[static_cast<Eigen::Index>(i)];
    if (jet.drive == Drive::kGained) {
      sum += at(jet.position, force * down);
    } else if (jet.drive == Drive::kMoved) {
      sum.tail<3>() += force * jet.axis.cross(down);
    } else {
      sum += at(jet.position, force * jet.axis);
    }
  }
  return sum;
}

Vector6 flow_wrench(const Craft& craft, const Eigen::VectorXd& told, const Vector6& nu_r) {
  Vector6 sum = Vector6::Zero();
  if (craft.craft_class == CraftClass::kRov) return sum;
  const Eigen::VectorXd acting = acting_forces(craft, told, nu_r);
  for (std::size_t i = 0; i < craft.jets.size(); ++i) {
    const Jet& jet = craft.jets[i];
    const double force = acting[static_cast<Eigen::Index>(i)];
    if (jet.drive == Drive::kPropeller) sum.tail<3>() -= jet.torque * force * jet.axis;
    if (jet.drive != Drive::kFin) continue;
    const double square = wash(craft, jet, acting, nu_r), along = std::copysign(std::sqrt(std::abs(square)), square);
    const Foil foil{jet.position, std::abs(jet.axis.y()) > 0.5, jet.area, jet.slope, jet.stall, jet.aspect};
    const double across = jet.axis.dot(speed_at(nu_r, jet.position));
    const double deflection = told[static_cast<Eigen::Index>(i)] / fin_unit(craft, jet);
    sum += at(jet.position, foil_force(craft.density, foil, deflection, along, across) - force * jet.axis);
  }
  for (const Foil& foil : craft.foils) {
    const Vector3d v = speed_at(nu_r, foil.position);
    sum += at(foil.position, foil_force(craft.density, foil, 0.0, v.x(), foil.upright ? v.y() : v.z()));
  }
  const double half = 0.5 * craft.density * craft.cross_drag;
  const double v = nu_r[1], w = nu_r[2], q = nu_r[4], r = nu_r[5];
  for (const Strip& strip : craft.strips) {
    const double aside = v + strip.x * r, below = w - strip.x * q;
    const double side = -half * strip.side * strip.length * aside * std::abs(aside);
    const double plan = -half * strip.plan * strip.length * below * std::abs(below);
    sum[1] += side;
    sum[2] += plan;
    sum[4] -= strip.x * plan;
    sum[5] += strip.x * side;
  }
  const Vector6 pure = pure_cross_drag(craft);
  sum += pure.cwiseProduct(nu_r.cwiseProduct(nu_r.cwiseAbs()));  // is part of the hull's diagonal drag
  return sum;
}

Vector6 pure_cross_drag(const Craft& craft) {
  Vector6 pure = Vector6::Zero();
  const double half = 0.5 * craft.density * craft.cross_drag;
  for (const Strip& strip : craft.strips) {
    const double cube = std::pow(std::abs(strip.x), 3);
    pure[1] += half * strip.side * strip.length;
    pure[2] += half * strip.plan * strip.length;
    pure[4] += half * strip.plan * strip.length * cube;
    pure[5] += half * strip.side * strip.length * cube;
  }
  return pure;
}

}  // namespace fathom::sealed
