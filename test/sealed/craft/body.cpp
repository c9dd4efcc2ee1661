#include "test/sealed/craft/body.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "test/sealed/craft/flow.hpp"

namespace fathom::sealed {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

Matrix3d cross_matrix(const Vector3d& a) {
  Matrix3d s;
  s << 0, -a[2], a[1], a[2], 0, -a[0], -a[1], a[0], 0;
  return s;
}

/// Coriolis and centripetal matrix of any symmetric mass matrix (Fossen 2011, theorem 3.2).
Matrix6 coriolis(const Matrix6& mass, const Vector6& nu) {
  const Vector3d linear = mass.topRows<3>() * nu, angular = mass.bottomRows<3>() * nu;
  Matrix6 c = Matrix6::Zero();
  c.topRightCorner<3, 3>() = -cross_matrix(linear);
  c.bottomLeftCorner<3, 3>() = -cross_matrix(linear);
  c.bottomRightCorner<3, 3>() = -cross_matrix(angular);
  return c;
}

/// Restoring forces g(eta), on the left-hand side (Fossen 2011, eq. 4.6), from W - B and W r_G - B r_B.
Vector6 restoring(double net_weight, const Vector3d& moment, const Vector3d& euler) {
  const double sphi = std::sin(euler[0]), cphi = std::cos(euler[0]), sth = std::sin(euler[1]), cth = std::cos(euler[1]);
  Vector6 g;
  g << net_weight * sth, -net_weight * cth * sphi, -net_weight * cth * cphi,
      -moment[1] * cth * cphi + moment[2] * cth * sphi, moment[2] * sth + moment[0] * cth * cphi,
      -moment[0] * cth * sphi - moment[1] * sth;
  return g;
}

}  // namespace

Matrix3d turn_of(const Vector3d& e) {
  const double sf = std::sin(e[0]), cf = std::cos(e[0]), st = std::sin(e[1]), ct = std::cos(e[1]), sp = std::sin(e[2]),
               cp = std::cos(e[2]);
  Matrix3d r;
  r << cp * ct, -sp * cf + cp * st * sf, sp * sf + cp * cf * st,  //
      sp * ct, cp * cf + sf * st * sp, -cp * sf + st * sp * cf,   //
      -st, ct * sf, ct * cf;
  return r;
}

void Commands::at(double t, Eigen::VectorXd& out) const {
  constexpr double kRounding = 1e-6;  // of dt: at a row, its own force
  const double last = static_cast<double>(force.size() - 1);
  double place = std::clamp((t - begin) / dt, 0.0, last);
  if (hold == Hold::kAfter) place = std::min(std::floor(place + kRounding), last);
  if (hold == Hold::kBefore) place = std::max(std::ceil(place - kRounding), 0.0);
  const auto i = std::min(static_cast<std::size_t>(place), force.size() - 1), j = std::min(i + 1, force.size() - 1);
  const double share = place - static_cast<double>(i);
  out = (1.0 - share) * force[i] + share * force[j];
}

Body::Body(const Craft& craft, const Mechanisms& mechanisms)
    : hull(craft.hull), craft_(craft), mechanisms_(mechanisms), allocation_(craft.allocation()) {
  for (const auto& mechanism : mechanisms_) {
    place_.push_back(memory_);
    memory_ += mechanism->memory();
    delay_ += mechanism->delay();
  }
  own_delay_.setZero(allocation_.cols());
  for (const auto& mechanism : mechanisms_) {
    for (Eigen::Index i = 0; i < own_delay_.size(); ++i) own_delay_[i] += mechanism->delay_of(i);
  }
  for (State* s : {&k1_, &k2_, &k3_, &k4_, &trial_}) *s = State::Zero(kMemory + memory_);
}

State Body::at_rest(const Vector3d& position, double heading) const {
  State state = State::Zero(kMemory + memory_);
  state.head<3>() = position;
  state[5] = heading;
  return state;
}

void Body::rate(double t, const State& state, const Commands& commands, State& out) {
  Instant at;
  at.t = t;
  at.position = state.segment<3>(kPose);
  at.euler = state.segment<3>(kPose + 3);
  at.turn = turn_of(at.euler);
  at.nu = state.segment<6>(kSpeed);
  const Vector3d omega = at.nu.tail<3>();

  Water water;
  for (const auto& mechanism : mechanisms_) mechanism->water(t, at.position, water);
  const Vector3d stream = at.turn.transpose() * water.velocity;
  const Vector3d surge = at.turn.transpose() * water.acceleration;
  at.nu_r = at.nu;
  at.nu_r.head<3>() -= stream;
  Vector6 stream_rate = Vector6::Zero();
  stream_rate.head<3>() = -omega.cross(stream) + surge;

  commands.at(t - delay_, force_);
  for (Eigen::Index i = 0; i < own_delay_.size(); ++i) {
    if (own_delay_[i] == 0.0) continue;
    commands.at(t - delay_ - own_delay_[i], late_);
    force_[i] = late_[i];
  }
  Terms terms;
  const auto memory_of = [&](std::size_t i) {
    return std::pair{
        std::span<const double>(state.data() + kMemory + place_[i], static_cast<std::size_t>(mechanisms_[i]->memory())),
        std::span<double>(out.data() + kMemory + place_[i], static_cast<std::size_t>(mechanisms_[i]->memory()))};
  };
  for (std::size_t i = 0; i < mechanisms_.size(); ++i) {
    const auto [z, rate] = memory_of(i);
    mechanisms_[i]->thrust(at, z, rate, force_);
  }
  const bool flows = craft_.craft_class != CraftClass::kRov;
  if (flows) acting_ = acting_forces(craft_, force_, at.nu_r);
  at.force = flows ? &acting_ : &force_;
  for (std::size_t i = 0; i < mechanisms_.size(); ++i) {
    const auto [z, rate] = memory_of(i);
    mechanisms_[i]->body(at, z, rate, terms);
  }

  Matrix6 rigid = Matrix6::Zero();
  rigid.diagonal() << Vector3d::Constant(hull.mass + terms.mass), hull.inertia;
  if (!terms.centre.isZero(0.0)) {  // Fossen 2011, eq. 3.44, and Steiner's theorem
    const Matrix3d arm = cross_matrix(terms.centre);
    rigid.topRightCorner<3, 3>() = -hull.mass * arm;
    rigid.bottomLeftCorner<3, 3>() = hull.mass * arm;
    rigid.bottomRightCorner<3, 3>() -= hull.mass * arm * arm;
  }
  Matrix6 added = terms.added;
  added.diagonal() += hull.added;
  const Vector6 drag = terms.drag_factor.cwiseProduct(hull.linear + hull.quadratic.cwiseProduct(at.nu_r.cwiseAbs()));
  Vector6 right = allocation_ * force_ + terms.wrench;
  if (flows) {
    right = push_of(craft_, acting_, at.turn.row(2).transpose()) + flow_wrench(craft_, force_, at.nu_r) + terms.wrench;
  }
  right -= coriolis(rigid, at.nu) * at.nu + coriolis(added, at.nu_r) * at.nu_r + drag.cwiseProduct(at.nu_r);
  right -= restoring(hull.net_weight + terms.net_weight, hull.first_moment + terms.first_moment, at.euler);
  right += added * stream_rate;
  right.head<3>() +=
      (hull.mass - hull.net_weight / kGravity) * surge;  // Froude and Krylov: the displaced water's share
  const Matrix6 mass = rigid + added;
  if (craft_.surfaced) {  // the surface bears what pushes up and down, rolls and pitches
    Eigen::Matrix3d level;
    constexpr std::array kFree{0, 1, 5};
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j)
        level(i, j) = mass(kFree[static_cast<std::size_t>(i)], kFree[static_cast<std::size_t>(j)]);
    }
    const Vector3d gained = level.ldlt().solve(Vector3d(right[0], right[1], right[5]));
    out.segment<6>(kSpeed) << gained[0], gained[1], 0.0, 0.0, 0.0, gained[2];
  } else {
    out.segment<6>(kSpeed) = mass.ldlt().solve(right);
  }

  out.segment<3>(kPose) = at.turn * at.nu.head<3>();
  const double sf = std::sin(at.euler[0]), cf = std::cos(at.euler[0]), tt = std::tan(at.euler[1]);
  const double about = omega[1] * sf + omega[2] * cf;
  out[3] = omega[0] + about * tt;
  out[4] = omega[1] * cf - omega[2] * sf;
  out[5] = about / std::cos(at.euler[1]);
}

void Body::step(double t, double h, const Commands& commands, State& state) {
  // A step that ends where the force jumps sees the force before the jump.
  const double inside = commands.hold == Hold::kLine ? 0.0 : 1e-4 * h;
  rate(t + inside, state, commands, k1_);
  trial_ = state + 0.5 * h * k1_;
  rate(t + 0.5 * h, trial_, commands, k2_);
  trial_ = state + 0.5 * h * k2_;
  rate(t + 0.5 * h, trial_, commands, k3_);
  trial_ = state + h * k3_;
  rate(t + h - inside, trial_, commands, k4_);
  state += h / 6.0 * (k1_ + 2.0 * k2_ + 2.0 * k3_ + k4_);
}

double Body::energy(const State& state) const {
  Vector6 mass;
  mass << Vector3d::Constant(hull.mass), hull.inertia;
  mass += hull.added;
  const Vector6 nu = state.segment<6>(kSpeed);
  const Vector3d down = turn_of(state.segment<3>(3)).row(2);  // the world's down, in the body
  return 0.5 * nu.cwiseAbs2().dot(mass) - hull.net_weight * state[2] - hull.first_moment.dot(down);
}

}  // namespace fathom::sealed
