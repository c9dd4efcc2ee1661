// Ships in surge, sway and yaw: hull, propeller and rudder as modules (H. Yasukawa and Y. Yoshimura, "Introduction of
// MMG standard method for ship maneuvering predictions", J. Marine Science and Technology 20, 2015). Hull by products
// of v' = v/U and r' = r L/U, times 1/2 rho L d U^2, about midships; surge and sway have added mass' Coriolis terms,
// N_v has the Munk moment. How hull, propeller and rudder act on each other is `interaction` of the vehicle file, by
// his symbols; propeller and rudder are those of its `actuators`.
#include <array>
#include <cmath>
#include <numbers>

#include "common/model/actuators.hpp"
#include "common/model/manoeuvring/series.hpp"
#include "common/model/manoeuvring/standard_set.hpp"
#include "common/model/motion.hpp"
#include "common/model/vehicle.hpp"

namespace fathom::model {
namespace mmg_set {
namespace {

constexpr double kNoFlow = 1e-9;    // m/s: no speed to divide by
constexpr double kSternway = 1e-3;  // m/s at the propeller: below it no advance ratio is told

double resistance(const TermMotion& n) { return -of_series<0, 0, 0, 0>(n); }

template <int b, int c>
constexpr ManoeuvringTerm term(std::string_view name, int axis) {
  return series_term<0, b, c, 0>(name, axis, TermScale::kDraught);
}

constexpr std::array<ManoeuvringTerm, 19> kTerms{
    {{.name = "R_0", .axis = 0, .power = 2, .value = resistance, .scale = TermScale::kDraught},
     term<2, 0>("X_vv", 0),
     term<1, 1>("X_vr", 0),
     term<0, 2>("X_rr", 0),
     term<4, 0>("X_vvvv", 0),
     term<0, 0>("Y_0", 1),
     term<1, 0>("Y_v", 1),
     term<0, 1>("Y_r", 1),
     term<3, 0>("Y_vvv", 1),
     term<2, 1>("Y_vvr", 1),
     term<1, 2>("Y_vrr", 1),
     term<0, 3>("Y_rrr", 1),
     term<0, 0>("N_0", 5),
     term<1, 0>("N_v", 5),
     term<0, 1>("N_r", 5),
     term<3, 0>("N_vvv", 5),
     term<2, 1>("N_vvr", 5),
     term<1, 2>("N_vrr", 5),
     term<0, 3>("N_rrr", 5)}};

/// Hull and wake at a motion, by the paper's symbols.
struct Flow {
  double u{}, U{}, beta{}, r_dash{}, wake{};  ///< m/s, m/s, rad, dimensionless
};

Flow flow_of(const Hydrodynamics& h, const Motion& motion) {
  const Interaction& i = *h.interaction;
  const Vector6d nu_r = motion.nu_r();
  Flow flow{.u = nu_r[0], .U = std::hypot(nu_r[0], nu_r[1])};
  flow.beta = flow.U > kNoFlow ? std::atan2(-nu_r[1], nu_r[0]) : 0.0;
  flow.r_dash = flow.U > kNoFlow ? nu_r[5] * h.length / flow.U : 0.0;
  const double beta_P = flow.beta - i.x_P * flow.r_dash;
  const double changed_to = i.C_2[beta_P > 0.0 ? 1 : 0];
  flow.wake = 1.0 - (1.0 - i.w_P) * (1.0 + (1.0 - std::exp(-i.C_1 * std::abs(beta_P))) * (changed_to - 1.0));
  return flow;
}

/// Thrust [N] of a propeller in the wake: its force in still water, less what it loses by its advance.
double thrust_of(const Hydrodynamics& h, const Vehicle& vehicle, const Thruster& one, double told, const Flow& flow) {
  const double size = std::sqrt(std::abs(told) / (told < 0.0 ? one.astern : 1.0)), u_P = flow.u * (1.0 - flow.wake);
  const double square = vehicle.water_density * one.diameter * one.diameter * h.interaction->K_TJJ;
  return told - one.inflow * size * u_P + (told > 0.0 && u_P > 0.0 ? square * u_P * u_P : 0.0);
}

/// Flow along a rudder behind a propeller of this thrust, with K_T / J^2 = T / (rho D^2 u_P^2).
double along_rudder(const Hydrodynamics& h, const Vehicle& vehicle, double diameter, double thrust, const Flow& flow) {
  const Interaction& i = *h.interaction;
  const double u_P = flow.u * (1.0 - flow.wake);
  if (u_P < kSternway || diameter <= 0.0) return i.epsilon * u_P;
  const double load =
      std::max(1.0 + 8.0 * thrust / (std::numbers::pi * vehicle.water_density * diameter * diameter * u_P * u_P), 0.0);
  const double race = 1.0 + i.kappa * (std::sqrt(load) - 1.0);
  return i.epsilon * u_P * std::sqrt(i.eta * race * race + 1.0 - i.eta);
}

Vector6d by_modules(const Vehicle& vehicle, const Motion& motion) {
  const Hydrodynamics& h = *vehicle.hydrodynamics;
  if (!h.interaction) return acting_wrench(vehicle, motion);
  const Interaction& i = *h.interaction;
  const Flow flow = flow_of(h, motion);
  Vector6d sum = Vector6d::Zero();
  for (std::size_t k = 0; k < vehicle.thrusters.size(); ++k) {
    const Thruster& one = vehicle.thrusters[k];
    const auto place = static_cast<Eigen::Index>(k);
    const double told = motion.force[place];
    if (!one.fin && one.diameter > 0.0) {
      sum += (1.0 - i.t_P) * thrust_of(h, vehicle, one, told, flow) * vehicle.allocation.col(place);
      continue;
    }
    if (!one.fin) {
      sum += acting_wrench(vehicle, motion, place);
      continue;
    }
    double thrust = 0.0, diameter = 0.0;
    if (one.fin->behind >= 0) {
      const auto ahead = static_cast<std::size_t>(one.fin->behind);
      diameter = vehicle.thrusters[ahead].diameter;
      thrust = thrust_of(h, vehicle, vehicle.thrusters[ahead], motion.force[one.fin->behind], flow);
    }
    const double side = one.axis_B.y() > 0.0 ? -1.0 : 1.0;  // the paper's angle is positive where the ship turns right
    const double delta = side * told / one.fin->slope;
    const double beta_R = flow.beta - i.l_R * flow.r_dash;
    const double v_R = flow.U * i.gamma_R[beta_R > 0.0 ? 1 : 0] * beta_R;
    const double u_R = along_rudder(h, vehicle, diameter, thrust, flow);
    const double slope = one.fin->slope / (one.fin->reference_speed * one.fin->reference_speed);  // 1/2 rho A f_alpha
    const double F_N = slope * (u_R * u_R + v_R * v_R) * std::sin(delta - std::atan2(v_R, u_R));
    sum[0] -= (1.0 - i.t_R) * F_N * std::sin(delta);
    sum[1] -= (1.0 + i.a_H) * F_N * std::cos(delta);
    sum[5] -= (one.p_BJ.x() + i.a_H * i.x_H * h.length) * F_N * std::cos(delta);
  }
  return sum;
}

}  // namespace
}  // namespace mmg_set

const StandardSet& mmg_3() {
  static const StandardSet set{.name = "mmg_3",
                               .source = "Yasukawa and Yoshimura 2015",
                               .terms = mmg_set::kTerms,
                               .moves = {true, true, false, false, false, true},
                               .coriolis = AddedCoriolis::kForces,
                               .needs_draught = true,
                               .pushed = mmg_set::by_modules};
  return set;
}

}  // namespace fathom::model
