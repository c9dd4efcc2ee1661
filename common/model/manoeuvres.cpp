#include "common/model/manoeuvres.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include "common/base/error.hpp"
#include "common/base/factors.hpp"
#include "common/model/derivative_motion.hpp"
#include "common/model/manoeuvring/helm.hpp"
#include "common/model/motion.hpp"

namespace fathom::model {
namespace {

constexpr double kHanging = 0.05;    // m/s and rad/s, together: still on its way to rest after that long
constexpr double kDamping = 1.0;     // 1/s
constexpr double kRunaway = 10.0;    // m/s and rad/s: ten times what a small vehicle can do
constexpr double kFaster = 3.0;      // times its cruising speed: no more than that
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

Forces forces(const Vehicle& vehicle, const State& state, const ActuatorForces& thrust,
              const Eigen::Vector3d& extra_W) {
  Motion motion{.p_WB = state.p, .R_WB = state.q.toRotationMatrix(), .nu = state.nu};
  motion.force = thrust;
  motion.vehicle = &vehicle;
  Forces f;
  f.attached = attached(vehicle, state.p, motion.R_WB, state.nu, extra_W);
  const Vector6d sum = vehicle.hydrodynamics->set->pushed(vehicle, motion) + f.attached.umbilical + f.attached.chain +
                       rigid_wrench(vehicle, motion.R_WB.row(2).transpose(), state.nu) + hull_wrench(vehicle, motion);
  f.nu_dot = accelerated(vehicle, total_inertia(vehicle), sum);
  return f;
}

void step(const Vehicle& vehicle, State& state, const ActuatorForces& thrust, const Eigen::Vector3d& extra_W) {
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
  const ActuatorForces none = ActuatorForces::Zero(vehicle.allocation.cols());
  State state;
  state.p.z() = vehicle.hydrodynamics->chain ? vehicle.hydrodynamics->chain->seabed - 1.0 : 5.0;
  const State begin = state;
  const auto moves = [&] { return !state.nu.allFinite() || state.nu.norm() > kHanging; };
  for (double t = 0.0; t < kSettling && state.nu.allFinite(); t += kStep)
    step(vehicle, state, none, Eigen::Vector3d::Zero());
  if (moves()) {
    // Products of velocities vanish at rest: where it is does not depend on derivatives, and these do not lead there.
    Vehicle damped = vehicle;
    damped.hydrodynamics->coefficients.clear();
    state = begin;
    for (double t = 0.0; t < kSettling; t += kStep) {
      step(damped, state, none, Eigen::Vector3d::Zero());
      state.nu *= 1.0 - kDamping * kStep;
    }
  }
  const double yaw = euler_from_rotation(state.q.toRotationMatrix()).z();
  return {state.p.z(), Eigen::AngleAxisd(-yaw, Eigen::Vector3d::UnitZ()) * state.q};
}

std::string Divergence::text() const {
  constexpr std::array kVelocity{"u", "v", "w", "p", "q", "r"};
  const bool turn = axis >= 3;
  char line[160];
  const int n = std::snprintf(line, sizeof line, "diverges at %.1f s along %s (%.3g %s)", t,
                              kVelocity[static_cast<std::size_t>(axis)], velocity, turn ? "rad/s" : "m/s");
  if (!term.empty() && n > 0)
    std::snprintf(line + n, sizeof line - static_cast<std::size_t>(n), ", driven by %s with %.3g %s", term.c_str(),
                  force, term[0] >= 'K' && term[0] <= 'N' ? "N m" : "N");
  return line;
}

namespace {

/// What each derivative has done to a motion that grows: its work since the motion was twice what such a vehicle can
/// do.
class Growth {
 public:
  explicit Growth(const Vehicle& vehicle) : vehicle_{vehicle}, work_(vehicle.hydrodynamics->coefficients.size(), 0.0) {}

  void see(const Vector6d& nu) {
    if (!(nu.cwiseAbs().maxCoeff() > kGrowing)) return;
    for (std::size_t i = 0; i < work_.size(); ++i)
      work_[i] += kStep * force(i, nu) * nu[vehicle_.hydrodynamics->coefficients[i].term->axis];
  }
  /// The fastest axis, and of the derivatives along it, else of all, the one that has put most into the motion.
  [[nodiscard]] Divergence found(double t, const Vector6d& nu) const {
    Divergence result{.t = t};
    nu.cwiseAbs().maxCoeff(&result.axis);
    result.velocity = nu[result.axis];
    const auto& all = vehicle_.hydrodynamics->coefficients;
    std::optional<std::size_t> most;
    for (const bool any : {false, true}) {
      for (std::size_t i = 0; i < work_.size() && !(any && most && all[*most].term->axis == result.axis); ++i) {
        if ((any || all[i].term->axis == result.axis) && work_[i] > (most ? work_[*most] : 0.0)) most = i;
      }
    }
    if (!most) return result;
    result.term = all[*most].term->name;
    result.force = force(*most, nu);
    return result;
  }

 private:
  static constexpr double kGrowing = 2.0;  // m/s and rad/s
  [[nodiscard]] double force(std::size_t i, const Vector6d& nu) const {
    const Hydrodynamics& h = *vehicle_.hydrodynamics;
    const ManoeuvringCoefficient& one = h.coefficients[i];
    TermMotion motion{nu};
    motion.cruise = h.cruise;
    return one.value * manoeuvring_scale(*one.term, h.lengths(vehicle_.water_density)) * one.term->value(motion);
  }

  const Vehicle& vehicle_;
  std::vector<double> work_;
};

}  // namespace

std::vector<FlightMoment> fly(const Vehicle& vehicle, const Manoeuvre& manoeuvre, double dt,
                              const Disturbance& disturbance, std::optional<Divergence>* diverged) {
  require_derivatives(vehicle);
  Helm helm{vehicle, manoeuvre};
  const HangingRest rest = helm.steered() ? HangingRest{} : hanging_rest(vehicle);
  if (!std::isfinite(rest.depth)) throw InputError(vehicle.name + ": with these derivatives it does not come to rest");
  State state;
  if (helm.steered()) state.nu[0] = vehicle.hydrodynamics->cruise;
  state.q = Eigen::AngleAxisd(manoeuvre.heading, Eigen::Vector3d::UnitZ()) * rest.q_WB;
  state.p << manoeuvre.start.head<2>(), rest.depth;

  std::vector<FlightMoment> flight;
  const auto every = static_cast<long>(std::lround(dt / kStep));
  const auto steps = static_cast<long>(std::lround(manoeuvre.duration / kStep));
  ManoeuvrePilot pilot{manoeuvre};
  Growth growth{vehicle};
  double yaw = manoeuvre.heading;
  const double runaway = std::max(kRunaway, kFaster * vehicle.hydrodynamics->cruise);
  for (long k = 0; k <= steps; ++k) {
    const double t = static_cast<double>(k) * kStep;
    const ActuatorForces& thrust = helm.forces(pilot.demand(t, yaw), kStep);
    const Eigen::Vector3d extra = disturbance ? disturbance(t) : Eigen::Vector3d(Eigen::Vector3d::Zero());
    if (k % std::max(every, 1L) == 0) {
      const Forces f = forces(vehicle, state, thrust, extra);
      flight.push_back({.t = t,
                        .p_WB = state.p,
                        .q_WB = state.q,
                        .nu = state.nu,
                        .nu_dot = f.nu_dot,
                        .thrust = {thrust.begin(), thrust.end()},
                        .umbilical = f.attached.umbilical,
                        .chain = f.attached.chain,
                        .F_umbilical_B = f.attached.F_umbilical_B,
                        .F_chain_B = f.attached.F_chain_B});
    }
    step(vehicle, state, thrust, extra);
    yaw = euler_from_rotation(state.q.toRotationMatrix()).z();
    growth.see(state.nu);
    // Seen while the numbers still mean something: what runs away is past this within a second.
    if (!state.nu.allFinite() || state.nu.cwiseAbs().maxCoeff() > runaway) {
      const Divergence found = growth.found(t, state.nu);
      if (diverged == nullptr) throw InputError(vehicle.name + ": with these derivatives the motion " + found.text());
      *diverged = found;
      break;
    }
  }
  return flight;
}

Vector6d hydrodynamic_wrench(const Vehicle& vehicle, const Eigen::Quaterniond& q_WB, const Vector6d& nu,
                             const Vector6d& nu_dot, const Vector6d& known) {
  const Eigen::Vector3d down_B = q_WB.conjugate() * Eigen::Vector3d::UnitZ();
  return total_inertia(vehicle) * nu_dot - rigid_wrench(vehicle, down_B, nu) - known;
}

}  // namespace fathom::model
