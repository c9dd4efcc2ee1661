#include "common/model/manoeuvres.hpp"

#include <algorithm>
#include <cmath>

#include "common/base/error.hpp"
#include "common/model/derivative_motion.hpp"

namespace fathom::model {
namespace {

constexpr double kStep = 0.01;       // s
constexpr double kSettling = 400.0;  // s in which a vehicle comes to rest on its chain

struct State {
  Eigen::Vector3d p{Eigen::Vector3d::Zero()};
  Eigen::Quaterniond q{Eigen::Quaterniond::Identity()};
  Vector6d nu{Vector6d::Zero()};
};

struct Forces {
  Attached attached;
  Vector6d nu_dot{Vector6d::Zero()};
};

Forces forces(const Vehicle& vehicle, const State& state, const Vector6d& thrust, const Eigen::Vector3d& extra_W) {
  const Hydrodynamics& h = *vehicle.hydrodynamics;
  const Eigen::Matrix3d R = state.q.toRotationMatrix();
  Forces f;
  f.attached = attached(vehicle, state.p, R, state.nu, extra_W);
  const Vector6d sum = thrust + f.attached.umbilical + f.attached.chain +
                       rigid_wrench(vehicle, R.row(2).transpose(), state.nu) +
                       manoeuvring_wrench(h.coefficients, state.nu, h.length, vehicle.water_density);
  f.nu_dot = sum.cwiseQuotient(total_inertia(vehicle));
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

}  // namespace

ManoeuvreKind manoeuvre_from(const std::string& name) {
  if (name == "line") return ManoeuvreKind::kLine;
  if (name == "zigzag") return ManoeuvreKind::kZigzag;
  if (name == "circle") return ManoeuvreKind::kCircle;
  throw InputError("'" + name + "' is no manoeuvre: line, zigzag, circle");
}

Manoeuvre manoeuvre_preset(const std::string& name) {
  Manoeuvre m{.kind = manoeuvre_from(name)};
  if (m.kind == ManoeuvreKind::kLine) m.duration = 60.0;
  if (m.kind == ManoeuvreKind::kZigzag) m.difference = 4.5;
  return m;
}

ManoeuvrePilot::Demand ManoeuvrePilot::demand(double t, double yaw) {
  const Manoeuvre& m = manoeuvre_;
  if (t < m.rest || t > m.duration) return {};
  if (t < m.rest + m.straight || m.kind == ManoeuvreKind::kLine) return {m.thrust, 0.0};
  if (m.kind == ManoeuvreKind::kCircle) return {m.thrust, -m.difference};
  if (side_ * wrap_angle(yaw - m.heading) > m.swing) side_ = -side_;
  return {m.thrust, side_ * m.difference};
}

std::vector<double> ManoeuvrePilot::thrust(double t, double yaw) {
  const Demand demand = this->demand(t, yaw);
  return {demand.ahead + demand.turn, demand.ahead - demand.turn};
}

HangingRest hanging_rest(const Vehicle& vehicle) {
  require_derivatives(vehicle);
  State state;
  state.p.z() = vehicle.hydrodynamics->chain ? vehicle.hydrodynamics->chain->seabed - 1.0 : 5.0;
  for (double t = 0.0; t < kSettling; t += kStep) step(vehicle, state, Vector6d::Zero(), Eigen::Vector3d::Zero());
  const double yaw = euler_from_rotation(state.q.toRotationMatrix()).z();
  return {state.p.z(), Eigen::AngleAxisd(-yaw, Eigen::Vector3d::UnitZ()) * state.q};
}

std::vector<FlightMoment> fly(const Vehicle& vehicle, const Manoeuvre& manoeuvre, double dt,
                              const Disturbance& disturbance) {
  const HangingRest rest = hanging_rest(vehicle);
  if (vehicle.thrusters.size() != 2) throw InputError(vehicle.name + ": these manoeuvres are flown with two thrusters");
  State state;
  state.q = Eigen::AngleAxisd(manoeuvre.heading, Eigen::Vector3d::UnitZ()) * rest.q_WB;
  state.p << manoeuvre.start.head<2>(), rest.depth;

  std::vector<FlightMoment> flight;
  const auto every = static_cast<long>(std::lround(dt / kStep));
  const auto steps = static_cast<long>(std::lround(manoeuvre.duration / kStep));
  ManoeuvrePilot pilot{manoeuvre};
  double yaw = manoeuvre.heading;
  for (long k = 0; k <= steps; ++k) {
    const double t = static_cast<double>(k) * kStep;
    const std::vector<double> thrust = pilot.thrust(t, yaw);
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
                        .umbilical = f.attached.umbilical,
                        .chain = f.attached.chain,
                        .F_umbilical_B = f.attached.F_umbilical_B,
                        .F_chain_B = f.attached.F_chain_B});
    }
    step(vehicle, state, tau, extra);
    yaw = euler_from_rotation(state.q.toRotationMatrix()).z();
    if (!state.nu.allFinite() || state.nu.norm() > 50.0) {
      throw InputError(vehicle.name + ": with these derivatives the motion diverges");
    }
  }
  return flight;
}

Vector6d hydrodynamic_wrench(const Vehicle& vehicle, const Eigen::Quaterniond& q_WB, const Vector6d& nu,
                             const Vector6d& nu_dot, const Vector6d& known) {
  const Eigen::Vector3d down_B = q_WB.conjugate() * Eigen::Vector3d::UnitZ();
  return total_inertia(vehicle).cwiseProduct(nu_dot) - rigid_wrench(vehicle, down_B, nu) - known;
}

}  // namespace fathom::model
