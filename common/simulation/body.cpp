#include "common/simulation/body.hpp"

#include <algorithm>
#include <cmath>
#include <span>

namespace fathom::simulation {
namespace {

constexpr double kLookBack = 2.0;  // s: longer than any delay of the registry
constexpr double kTaut = 0.05;     // m/s at which an umbilical trails and pulls

}  // namespace

Body::Body(model::Model truth, const Hull& hull, const BatteryTruth& battery, const StartPose& start, Utime origin,
           Utime step, const std::optional<DerivativeTruth>& derivatives)
    : truth_{std::move(truth)},
      hull_{hull},
      battery_{battery},
      origin_{origin},
      step_{step},
      derivatives_{derivatives},
      stream_{derivatives ? derivatives->seed : 0, "umbilical"} {
  now_.p = start.p_WB;
  now_.q = Eigen::Quaterniond{rotation_from_euler({0.0, 0.0, start.heading})} * start.tilt;
  before_ = now_;
  force_.setZero(truth_.allocation.cols());
  memory_.assign(static_cast<std::size_t>(truth_.memory_size()), 0.0);
  const auto kept = static_cast<std::size_t>(kLookBack * 1e6 / static_cast<double>(step)) + 2;
  history_.assign(2 * kept, Eigen::VectorXd::Zero(truth_.allocation.cols()));
  oldest_ = 0;
  remember(0.0);
  model::settle(truth_, motion(0.0, now_), memory_);
}

void Body::drive(const model::ActuatorForces& force) { force_ = force; }

double Body::voltage() const {
  if (battery_.full <= 0.0) return 0.0;
  double volts = battery_.full - battery_.fall * seconds();
  for (const double each : force_) volts -= battery_.sag * std::pow(std::abs(each), 1.5);
  return std::max(volts, battery_.lowest);
}

// The window slides through a list of twice its length, so that the numbers lie side by side and are moved seldom.
void Body::remember(double t) {
  const std::size_t kept = history_.size() / 2;
  if (oldest_ + kept == history_.size()) {
    for (std::size_t i = 0; i < kept; ++i) history_[i].swap(history_[oldest_ + i]);
    oldest_ = 0;
  }
  history_[oldest_ + kept] = force_;
  ++oldest_;
  const double dt = static_cast<double>(step_) * 1e-6;
  input_ = model::InputSignal{t - dt * static_cast<double>(kept - 1), dt, {history_.data() + oldest_, kept}};
}

model::Motion Body::motion(double t, const State& state) const {
  model::Motion motion{.t = t, .p_WB = state.p, .R_WB = state.q.toRotationMatrix(), .nu = state.nu};
  motion.force = force_;
  motion.voltage = voltage();
  motion.input = &input_;
  motion.vehicle = truth_.vehicle;
  return motion;
}

void Body::feel(model::Motion& motion, double dt) const {
  model::feel(truth_, motion, memory_, dt);
  motion.w_memory += hull_.wrench(motion.p_WB, motion.R_WB, motion.nu);  // enters the balance as any other wrench
}

void Body::pull(double dt) {
  if (!derivatives_ || derivatives_->pull <= 0.0) return;
  const double kept = std::exp(-dt / derivatives_->memory);
  process_ = kept * process_ + stream_.normal3(derivatives_->pull * std::sqrt(1.0 - kept * kept));
  pull_W_ = std::min(1.0, now_.nu.head<3>().norm() / kTaut) * process_;
}

model::Attached Body::attached(const model::Motion& motion) const {
  return model::attached(*truth_.vehicle, motion.p_WB, motion.R_WB, motion.nu, pull_W_, motion.v_WF_B);
}

Vector6d Body::slope(const model::Motion& motion) const {
  return derivatives_ ? model::derivative_acceleration(truth_, motion, attached(motion))
                      : model::acceleration(truth_, motion);
}

void Body::step() {
  const double h = static_cast<double>(step_) * 1e-6, half = 0.5 * h, t = seconds();
  remember(t);
  pull(h);
  before_ = now_;
  model::Motion begin = motion(t, before_);
  feel(begin, 0.0);
  slope_begin_ = slope(begin);
  State middle;
  middle.nu = before_.nu + half * slope_begin_;
  middle.p = before_.p + half * (begin.R_WB * before_.nu.head<3>());
  middle.q = before_.q * quaternion_from_rotation_vector(half * before_.nu.tail<3>());
  if (!memory_.empty()) {
    model::Motion advanced = motion(t + half, middle);
    model::feel(truth_, advanced, memory_, half);
  }
  model::Motion halfway = motion(t + half, middle);
  feel(halfway, 0.0);
  slope_middle_ = slope(halfway);
  now_.nu = before_.nu + h * slope_middle_;
  now_.p = before_.p + h * (halfway.R_WB * middle.nu.head<3>());
  now_.q = (before_.q * quaternion_from_rotation_vector(h * middle.nu.tail<3>())).normalized();
  if (!memory_.empty()) {
    model::Motion advanced = motion(t + h, now_);
    model::feel(truth_, advanced, memory_, half);
  }
  ++count_;
  hull_.count(now_.p, now_.q.toRotationMatrix(), seconds());
}

Moment Body::at(Utime utime) const {
  const double h = static_cast<double>(step_) * 1e-6;
  const double s = 1.0 - seconds_between(utime, now()) / h;  // share of the last step
  State state = now_;
  if (s < 1.0) {
    state.nu = before_.nu + s * h * (slope_begin_ + s * (slope_middle_ - slope_begin_));
    state.q = (before_.q *
               quaternion_from_rotation_vector(s * rotation_vector_from_quaternion(before_.q.conjugate() * now_.q)))
                  .normalized();
    const Eigen::Vector3d v_before = h * (before_.q * before_.nu.head<3>()), v_now = h * (now_.q * now_.nu.head<3>());
    const Eigen::Vector3d way = now_.p - before_.p;  // cubic by positions and velocities at both ends
    state.p = before_.p + s * way + s * (1.0 - s) * ((1.0 - s) * (v_before - way) - s * (v_now - way));
  }
  Moment moment{.utime = utime, .t = seconds_between(origin_, utime), .p_WB = state.p, .q_WB = state.q, .nu = state.nu};
  model::Motion felt = motion(moment.t, state);
  feel(felt, 0.0);
  moment.R_WB = felt.R_WB;
  moment.nu_dot = slope(felt);
  moment.nu_seen = moment.nu;
  moment.v_WF = felt.R_WB * felt.v_WF_B;
  moment.felt = felt.force;
  moment.tau_felt = truth_.allocation * felt.force;
  moment.voltage = felt.voltage;
  if (derivatives_) {
    const model::Attached pulls = attached(felt);
    moment.umbilical_B = pulls.F_umbilical_B;
    moment.chain_B = pulls.F_chain_B;
  }
  for (const model::ActiveEffect& active : truth_.effects) {
    if (!active.effect->name().starts_with("tether")) continue;
    model::Load load;
    active.effect->load(felt, active.theta, active.variant, load);
    moment.tether_B += load.wrench.head<3>();
  }
  return moment;
}

double Body::energy() const {
  const auto& theta = truth_.theta;
  const Eigen::Matrix3d R_WB = now_.q.toRotationMatrix();
  const double kinetic = 0.5 * now_.nu.dot(theta.head<6>().cwiseProduct(now_.nu));
  const double height = -theta[model::index(model::BaseParameter::W_B)] * now_.p.z();
  // Restoring moment G x down = -d/dq of -(G . down): energy -G . down.
  const double righting = -theta.segment<3>(model::index(model::BaseParameter::G_x)).dot(R_WB.row(2).transpose());
  return kinetic + height + righting + hull_.energy(now_.p, R_WB);
}

}  // namespace fathom::simulation
