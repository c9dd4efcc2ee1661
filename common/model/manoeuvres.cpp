#include "common/model/manoeuvres.hpp"

#include <algorithm>
#include <cmath>

#include "common/base/error.hpp"
#include "common/model/sensors/kinematic_point.hpp"

namespace fathom::model {
namespace {

constexpr double kStep = 0.01;       // s
constexpr double kSettling = 400.0;  // s in which a vehicle comes to rest on its chain
constexpr double kStiction =
    0.02;  // m/s at which friction has two thirds of its size: a chain creeps, it does not stick
constexpr double kSwept = 1.0 / 3.0;  // of a cable whose far end stands still: the mean of (s / L)^2

struct State {
  Eigen::Vector3d p{Eigen::Vector3d::Zero()};
  Eigen::Quaterniond q{Eigen::Quaterniond::Identity()};
  Vector6d nu{Vector6d::Zero()};
};

struct Forces {
  Eigen::Vector3d F_umbilical_B{Eigen::Vector3d::Zero()}, F_chain_B{Eigen::Vector3d::Zero()};
  Vector6d umbilical{Vector6d::Zero()}, chain{Vector6d::Zero()};
  Vector6d nu_dot{Vector6d::Zero()};
};

Vector6d at_origin(const Eigen::Vector3d& force, const Eigen::Vector3d& p) {
  Vector6d wrench;
  wrench << force, p.cross(force);
  return wrench;
}

Vector6d mass_of(const Vehicle& vehicle) {
  Vector6d mass = vehicle.hydrodynamics->added_mass;
  mass.head<3>().array() += vehicle.mass;
  mass.tail<3>() += vehicle.inertia;
  return mass;
}

/// Everything but inertia and what hydrodynamics and `known` give: weight, buoyancy, rigid Coriolis.
Vector6d rigid_wrench(const Vehicle& vehicle, const Eigen::Vector3d& down_B, const Vector6d& nu) {
  const Eigen::Vector3d v = nu.head<3>(), w = nu.tail<3>();
  const Eigen::Vector3d lift = -vehicle.buoyancy * down_B;
  Vector6d wrench;
  wrench.head<3>() = vehicle.mass * kGravity * down_B + lift - vehicle.mass * w.cross(v);
  wrench.tail<3>() = vehicle.hydrodynamics->p_BB.cross(lift) - w.cross(vehicle.inertia.cwiseProduct(w));
  return wrench;
}

Forces forces(const Vehicle& vehicle, const State& state, const Vector6d& thrust, const Eigen::Vector3d& extra_W) {
  const Hydrodynamics& h = *vehicle.hydrodynamics;
  const Eigen::Matrix3d R = state.q.toRotationMatrix();
  const Eigen::Vector3d v = state.nu.head<3>(), w = state.nu.tail<3>();
  Forces f;
  if (h.umbilical) {
    const Umbilical& u = *h.umbilical;
    const Eigen::Vector3d v_U = v + w.cross(u.p_BU);
    const double k = 0.5 * vehicle.water_density * u.drag_coefficient * u.diameter * u.paid_out * kSwept;
    f.F_umbilical_B = -k * v_U.norm() * v_U + R.transpose() * extra_W;
    f.umbilical = at_origin(f.F_umbilical_B, u.p_BU);
  }
  if (h.chain) {
    const Chain& c = *h.chain;
    const Eigen::Vector3d v_C = R * (v + w.cross(c.p_BC));
    const double height = c.seabed - (state.p + R * c.p_BC).z();
    const double lifted = std::clamp(height, 0.0, c.length);
    const double speed = std::hypot(v_C.x(), v_C.y());
    const double rub = c.friction * c.weight * (c.length - lifted) * std::tanh(speed / kStiction);
    Eigen::Vector3d F_W{0.0, 0.0, c.weight * lifted};
    if (speed > 0.0) F_W.head<2>() -= rub / speed * v_C.head<2>();
    f.F_chain_B = R.transpose() * F_W;
    f.chain = at_origin(f.F_chain_B, c.p_BC);
  }
  const Vector6d sum = thrust + f.umbilical + f.chain + rigid_wrench(vehicle, R.row(2).transpose(), state.nu) +
                       manoeuvring_wrench(h.coefficients, state.nu, h.length, vehicle.water_density);
  f.nu_dot = sum.cwiseQuotient(mass_of(vehicle));
  return f;
}

void step(const Vehicle& vehicle, State& state, const Vector6d& thrust, const Eigen::Vector3d& extra_W) {
  const Vector6d first = forces(vehicle, state, thrust, extra_W).nu_dot;
  State middle = state;
  middle.nu += 0.5 * kStep * first;
  middle.p += 0.5 * kStep * (state.q * state.nu.head<3>());
  middle.q = (state.q * quaternion_from_rotation_vector(0.5 * kStep * state.nu.tail<3>())).normalized();
  const Vector6d slope = forces(vehicle, middle, thrust, extra_W).nu_dot;
  state.p += kStep * (middle.q * middle.nu.head<3>());
  state.q = (state.q * quaternion_from_rotation_vector(kStep * middle.nu.tail<3>())).normalized();
  state.nu += kStep * slope;
}

/// Port and starboard thrust; `side` remembers to which side a zigzag turns.
std::vector<double> command(const Manoeuvre& m, double t, double turned, double& side) {
  if (t < m.rest) return {0.0, 0.0};
  if (t < m.rest + m.straight || m.kind == ManoeuvreKind::kLine) return {m.thrust, m.thrust};
  if (m.kind == ManoeuvreKind::kCircle) return {m.thrust - m.difference, m.thrust + m.difference};
  if (side * turned > m.swing) side = -side;
  return {m.thrust + side * m.difference, m.thrust - side * m.difference};
}

}  // namespace

ManoeuvreKind manoeuvre_from(const std::string& name) {
  if (name == "line") return ManoeuvreKind::kLine;
  if (name == "zigzag") return ManoeuvreKind::kZigzag;
  if (name == "circle") return ManoeuvreKind::kCircle;
  throw InputError("'" + name + "' is no manoeuvre: line, zigzag, circle");
}

std::vector<FlightMoment> fly(const Vehicle& vehicle, const Manoeuvre& manoeuvre, double dt,
                              const Disturbance& disturbance) {
  if (!vehicle.hydrodynamics || vehicle.mass <= 0.0 || vehicle.inertia.minCoeff() <= 0.0 || vehicle.buoyancy <= 0.0) {
    throw InputError(vehicle.name +
                     ": a manoeuvre needs mass, inertia, buoyancy and hydrodynamics in the vehicle file");
  }
  if (vehicle.thrusters.size() != 2) throw InputError(vehicle.name + ": these manoeuvres are flown with two thrusters");
  State state;
  state.p.z() = vehicle.hydrodynamics->chain ? vehicle.hydrodynamics->chain->seabed - 1.0 : 5.0;
  state.q = Eigen::AngleAxisd(manoeuvre.heading, Eigen::Vector3d::UnitZ());
  for (double t = 0.0; t < kSettling; t += kStep) step(vehicle, state, Vector6d::Zero(), Eigen::Vector3d::Zero());
  const double yaw = euler_from_rotation(state.q.toRotationMatrix()).z();
  state.q = Eigen::AngleAxisd(manoeuvre.heading - yaw, Eigen::Vector3d::UnitZ()) * state.q;
  state.p.head<2>() = manoeuvre.start.head<2>();

  std::vector<FlightMoment> flight;
  const auto every = static_cast<long>(std::lround(dt / kStep));
  const auto steps = static_cast<long>(std::lround(manoeuvre.duration / kStep));
  double side = 1.0, turned = 0.0;
  for (long k = 0; k <= steps; ++k) {
    const double t = static_cast<double>(k) * kStep;
    const std::vector<double> thrust = command(manoeuvre, t, turned, side);
    const Vector6d tau = vehicle.allocation * Eigen::Map<const Eigen::Vector2d>(thrust.data());
    const Eigen::Vector3d extra = disturbance ? disturbance(t) : Eigen::Vector3d(Eigen::Vector3d::Zero());
    if (k % std::max(every, 1L) == 0) {
      const Forces f = forces(vehicle, state, tau, extra);
      flight.push_back({.t = t,
                        .p_WB = state.p,
                        .q_WB = state.q,
                        .nu = state.nu,
                        .nu_dot = f.nu_dot,
                        .thrust = thrust,
                        .umbilical = f.umbilical,
                        .chain = f.chain,
                        .F_umbilical_B = f.F_umbilical_B,
                        .F_chain_B = f.F_chain_B});
    }
    step(vehicle, state, tau, extra);
    turned = wrap_angle(euler_from_rotation(state.q.toRotationMatrix()).z() - manoeuvre.heading);
    if (!state.nu.allFinite() || state.nu.norm() > 50.0) {
      throw InputError(vehicle.name + ": with these derivatives the motion diverges");
    }
  }
  return flight;
}

Vector6d hydrodynamic_wrench(const Vehicle& vehicle, const Eigen::Quaterniond& q_WB, const Vector6d& nu,
                             const Vector6d& nu_dot, const Vector6d& known) {
  const Eigen::Vector3d down_B = q_WB.conjugate() * Eigen::Vector3d::UnitZ();
  return mass_of(vehicle).cwiseProduct(nu_dot) - rigid_wrench(vehicle, down_B, nu) - known;
}

}  // namespace fathom::model
