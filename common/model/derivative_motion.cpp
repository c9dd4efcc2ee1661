#include "common/model/derivative_motion.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "common/base/error.hpp"
#include "common/base/factors.hpp"
#include "common/model/sensors/kinematic_point.hpp"

namespace fathom::model {
namespace {

constexpr double kStiction =
    0.02;  // m/s at which friction has two thirds of its size: a chain creeps, it does not stick
constexpr double kSwept = 1.0 / 3.0;  // of a cable whose far end stands still: the mean of (s / L)^2
constexpr std::array kSquares{"X_u|u|", "Y_v|v|", "Z_w|w|", "K_p|p|", "M_q|q|", "N_r|r|"};

Vector6d at_origin(const Eigen::Vector3d& force, const Eigen::Vector3d& p) {
  Vector6d wrench;
  wrench << force, p.cross(force);
  return wrench;
}

}  // namespace

void require_derivatives(const Vehicle& vehicle) {
  if (vehicle.hydrodynamics && vehicle.mass > 0.0 && vehicle.inertia.minCoeff() > 0.0 && vehicle.buoyancy > 0.0) return;
  throw InputError(vehicle.name + ": a manoeuvre needs mass, inertia, buoyancy and hydrodynamics in the vehicle file");
}

Matrix6d rigid_inertia(const Vehicle& vehicle) {
  const Hydrodynamics& h = *vehicle.hydrodynamics;
  const Eigen::Matrix3d S = skew(h.p_BG);
  Matrix6d M = Matrix6d::Zero();
  M.topLeftCorner<3, 3>().diagonal().setConstant(vehicle.mass);
  M.topRightCorner<3, 3>() = -vehicle.mass * S;
  M.bottomLeftCorner<3, 3>() = vehicle.mass * S;
  M.bottomRightCorner<3, 3>() = h.inertia(vehicle.inertia) - vehicle.mass * S * S;  // parallel axes
  return M;
}

Matrix6d total_inertia(const Vehicle& vehicle) { return rigid_inertia(vehicle) + vehicle.hydrodynamics->added_mass; }

Vector6d rigid_wrench(const Vehicle& vehicle, const Eigen::Vector3d& down_B, const Vector6d& nu) {
  const Eigen::Vector3d v = nu.head<3>(), w = nu.tail<3>();
  // Momentum about Bo, which stands still in W: its change in B turns with w, and Bo itself moves on with v.
  const Vector6d momentum = rigid_inertia(vehicle) * nu;
  const Eigen::Vector3d linear = momentum.head<3>(), angular = momentum.tail<3>();
  Vector6d wrench = at_origin(vehicle.mass * kGravity * down_B, vehicle.hydrodynamics->p_BG) +
                    at_origin(-vehicle.buoyancy * down_B, vehicle.hydrodynamics->p_BB);
  if (!vehicle.hydrodynamics->rigid_coriolis) return wrench;  // the coefficients have it
  wrench.head<3>() -= w.cross(linear);
  wrench.tail<3>() -= w.cross(angular) + v.cross(linear);
  return wrench;
}

Vector6d water_wrench(const Vehicle& vehicle, const Eigen::Vector3d& w, const Eigen::Vector3d& v_WF_B,
                      const Eigen::Vector3d& a_WF_B) {
  const Hydrodynamics& h = *vehicle.hydrodynamics;
  Vector6d wrench = at_origin(vehicle.buoyancy / kGravity * a_WF_B, h.p_BB);
  return wrench + h.added_mass.leftCols<3>() * (a_WF_B - w.cross(v_WF_B));
}

Eigen::Vector3d umbilical_drag(const Vehicle& vehicle, double paid_out, const Vector6d& nu,
                               const Eigen::Vector3d& v_WF_B) {
  const Umbilical& u = *vehicle.hydrodynamics->umbilical;
  const Eigen::Vector3d v_U = nu.head<3>() - v_WF_B + nu.tail<3>().cross(u.p_BU);
  const double k = 0.5 * vehicle.water_density * u.drag_coefficient * u.diameter * paid_out * kSwept;
  return -k * v_U.norm() * v_U;
}

Attached attached(const Vehicle& vehicle, const Eigen::Vector3d& p_WB, const Eigen::Matrix3d& R_WB, const Vector6d& nu,
                  const Eigen::Vector3d& pull_W, const Eigen::Vector3d& v_WF_B) {
  const Hydrodynamics& h = *vehicle.hydrodynamics;
  const Eigen::Vector3d v = nu.head<3>(), w = nu.tail<3>();
  Attached a;
  if (h.umbilical) {
    a.F_umbilical_B = umbilical_drag(vehicle, h.umbilical->paid_out, nu, v_WF_B) + R_WB.transpose() * pull_W;
    a.umbilical = at_origin(a.F_umbilical_B, h.umbilical->p_BU);
  }
  if (h.chain) {
    const Chain& c = *h.chain;
    const Eigen::Vector3d v_C = R_WB * (v + w.cross(c.p_BC));
    const double height = c.seabed - (p_WB + R_WB * c.p_BC).z();
    const double lifted = std::clamp(height, 0.0, c.length);
    const double speed = std::hypot(v_C.x(), v_C.y());
    const double rub = c.friction * c.weight * (c.length - lifted) * std::tanh(speed / kStiction);
    Eigen::Vector3d F_W{0.0, 0.0, c.weight * lifted};
    if (speed > 0.0) F_W.head<2>() -= rub / speed * v_C.head<2>();
    a.F_chain_B = R_WB.transpose() * F_W;
    a.chain = at_origin(a.F_chain_B, c.p_BC);
  }
  return a;
}

Vector6d derivative_acceleration(const Model& model, const Motion& motion, const Attached& attached) {
  const Vehicle& vehicle = *model.vehicle;
  Load load;
  load.clear();
  load.drag = by_coefficients(vehicle, motion);
  Vector6d force = motion.w_memory + load.drag + added_coriolis(vehicle, motion) + attached.umbilical + attached.chain +
                   rigid_wrench(vehicle, motion.R_WB.row(2).transpose(), motion.nu);
  if (model.motion_matters) {
    force += vehicle.hydrodynamics->set->pushed(vehicle, motion);
  } else {
    for (Eigen::Index i = 0; i < motion.force.size(); ++i) force += model.allocation.col(i) * motion.force[i];
  }
  force += water_wrench(vehicle, motion.nu.tail<3>(), motion.v_WF_B, motion.a_WF_B);
  for (const ActiveEffect& active : model.effects) active.effect->load(motion, active.theta, active.variant, load);
  force += load.wrench;
  return accelerated(vehicle, total_inertia(vehicle) + load.inertia(), force);
}

Vector6d accelerated(const Vehicle& vehicle, Matrix6d inertia, Vector6d force) {
  const auto& moves = vehicle.hydrodynamics->set->moves;
  for (Eigen::Index i = 0; i < 6; ++i) {
    if (moves[static_cast<std::size_t>(i)]) continue;
    inertia.row(i).setZero();
    inertia.col(i).setZero();
    inertia(i, i) = 1.0;
    force[i] = 0.0;
  }
  return InertiaFactor{inertia}.solve(force);
}

BaseTheta nearest_base(const Vehicle& vehicle) {
  const Hydrodynamics& h = *vehicle.hydrodynamics;
  BaseTheta theta = BaseTheta::Zero();
  theta.head<6>() = total_inertia(vehicle).diagonal();
  for (const ManoeuvringCoefficient& one : h.coefficients) {
    // Gertler's X_uu is that of a craft that goes ahead; in a series about a speed the name means another thing.
    const bool ahead = h.set == &gertler_submarine() && one.term->name == "X_uu";
    const auto square = ahead ? kSquares.begin() : std::find(kSquares.begin(), kSquares.end(), one.term->name);
    if (square == kSquares.end()) continue;
    theta[index(BaseParameter::X_uu) + (square - kSquares.begin())] =
        one.value * manoeuvring_scale(*one.term, h.lengths(vehicle.water_density));
  }
  theta[index(BaseParameter::W_B)] = vehicle.mass * kGravity - vehicle.buoyancy;
  theta.segment<3>(index(BaseParameter::G_x)) = vehicle.mass * kGravity * h.p_BG - vehicle.buoyancy * h.p_BB;
  return theta;
}

}  // namespace fathom::model
