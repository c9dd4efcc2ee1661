#include "common/planning/rehearsal.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "common/base/error.hpp"
#include "common/model/dynamics.hpp"
#include "common/model/thruster_allocation.hpp"

namespace fathom::planning {
namespace {

constexpr double kStep = 0.01;           // s of the simulation
constexpr int kSample = 5;               // steps between samples
constexpr Utime kBegin = 1'000'000'000;  // us: any
constexpr double kOpen = 3.0;            // m from the one boundary there is
constexpr double kStrong = 1e3;          // N of a thruster whose file states no limit: the site's limits hold

/// The vehicle file's model with thrusters that obey at once.
class Stage {
 public:
  Stage(const model::Vehicle& vehicle, const model::Model& model, bool by_wrench, const RehearsalSettings& settings,
        const Eigen::Vector3d& p_WB)
      : vehicle_{vehicle}, model_{model}, p_WB_{p_WB} {
    if (!by_wrench) allocation_.emplace(vehicle, vehicle.largest_thrust > 0.0 ? vehicle.largest_thrust : kStrong);
    force_ = model::ActuatorForces::Zero(model_.allocation.cols());
    slope_ = force_;
    trial_.name = "rehearsal";
    trial_.dt = kStep * kSample;
    trial_.observed = {true, true, true, true};
    trial_.input_is_wrench = by_wrench;
    trial_.input_step = trial_.dt;
    trial_.nu_sigma = settings.noise / std::sqrt(std::max(settings.rate * trial_.dt, 1.0));
  }

  [[nodiscard]] bool due() const { return steps_ % kSample == 0; }
  [[nodiscard]] Utime utime() const { return kBegin + steps_ * 10'000; }
  [[nodiscard]] double seconds() const { return static_cast<double>(steps_) * kStep; }
  [[nodiscard]] StateEstimate state() const {
    return {.utime = utime(), .p_WB = p_WB_, .q_WB = q_WB_, .nu = nu_, .valid = true};
  }
  [[nodiscard]] Thrusters thrusters() const {
    Thrusters t{.utime = utime(), .pwm_us = {}, .force = {}, .has_tau = true};
    const Vector6d tau = model_.allocation * force_;
    std::copy(tau.begin(), tau.end(), t.tau.begin());
    if (allocation_) t.force.assign(force_.begin(), force_.end());
    return t;
  }
  /// Reached in a straight line until the next sample, so that a fit of the trial knows the force at any time.
  void push(const Vector6d& tau) {
    model::ActuatorForces goal = tau;
    if (allocation_) {
      const model::Allocated given = allocation_->allocate(tau, 0.0);
      goal = Eigen::Map<const Eigen::VectorXd>(given.force.data(), static_cast<Eigen::Index>(given.force.size()));
    }
    slope_ = (goal - force_) / (kStep * kSample);
  }
  void record() {
    trial_.t.push_back(trial_.t.empty() ? 0.0 : trial_.t.back() + trial_.dt);
    trial_.p_WB.push_back(p_WB_);
    trial_.q_WB.push_back(q_WB_);
    trial_.nu.push_back(nu_);
    trial_.input.emplace_back(force_);
    for (auto* valid : {&trial_.pose_valid, &trial_.velocity_valid, &trial_.rates_valid}) valid->push_back(1);
  }
  void step() {
    force_ += 0.5 * kStep * slope_;
    const Vector6d halfway = nu_ + 0.5 * kStep * model::acceleration(model_, motion(nu_));
    nu_ += kStep * model::acceleration(model_, motion(halfway));
    p_WB_ += kStep * (q_WB_ * halfway.head<3>());
    q_WB_ = (q_WB_ * quaternion_from_rotation_vector(kStep * halfway.tail<3>())).normalized();
    force_ += 0.5 * kStep * slope_;
    ++steps_;
  }
  Trial take() { return std::move(trial_); }

 private:
  [[nodiscard]] model::Motion motion(const Vector6d& nu) const {
    model::Motion m{.t = seconds(), .p_WB = p_WB_, .R_WB = q_WB_.toRotationMatrix(), .nu = nu};
    m.force = force_;
    m.vehicle = &vehicle_;
    return m;
  }

  const model::Vehicle& vehicle_;
  model::Model model_;
  std::optional<model::ThrusterAllocation> allocation_;
  model::ActuatorForces force_, slope_;  // N, N/s
  Eigen::Vector3d p_WB_;
  Eigen::Quaterniond q_WB_{Eigen::Quaterniond::Identity()};
  Vector6d nu_{Vector6d::Zero()};
  std::int64_t steps_{0};
  Trial trial_;
};

/// Where a trial begins: the middle of the room, or a little inside the one side that it has.
Eigen::Vector3d start_in(const excitation::FenceSettings& fence) {
  Eigen::Vector3d start = Eigen::Vector3d::Zero();
  for (Eigen::Index i = 0; i < 3; ++i) {
    const bool low = std::isfinite(fence.low[i]), high = std::isfinite(fence.high[i]);
    if (low && high) {
      start[i] = 0.5 * (fence.low[i] + fence.high[i]);
    } else if (low || high) {
      start[i] = low ? fence.low[i] + kOpen : fence.high[i] - kOpen;
    }
  }
  return start;
}

}  // namespace

Rehearsal rehearse(const model::Vehicle& vehicle, const RehearsalSettings& settings) {
  const bool by_wrench = vehicle.thrusters.empty();
  Stage stage{vehicle, model::nominal_model(vehicle, by_wrench), by_wrench, settings,
              start_in(settings.supervisor.fence)};
  excitation::SupervisorSettings alone = settings.supervisor;
  alone.needs.clear();  // nobody else is there
  excitation::Supervisor supervisor{alone, vehicle};
  supervisor.hear(fathom::Answer{.gate = true, .challenge = 1, .authentic = true});
  identification::Identifier identifier{settings.identifier, vehicle};
  Rehearsal rehearsal;
  bool ordered = false;
  using excitation::Phase;
  while (stage.seconds() < settings.longest) {
    if (stage.due()) {
      const StateEstimate state = stage.state();
      for (const ModelEstimate& model : identifier.step(state).models) supervisor.hear(model);
      const auto& output = supervisor.step(state);
      if (output.excitation) identifier.hear(*output.excitation);
      const Phase phase = supervisor.phase();
      if (ordered && (phase == Phase::kDone || phase == Phase::kAborted || phase == Phase::kDisarmed)) break;
      if (output.command) stage.push(output.command->tau);
      for (const ModelEstimate& model : identifier.step(stage.thrusters()).models) supervisor.hear(model);
      if (!ordered) {
        supervisor.hear(Operator{.utime = state.utime,
                                 .sequence = 1,
                                 .challenge = 1,
                                 .enable = true,
                                 .order = "identify",
                                 .authentic = true});
        ordered = true;
      } else {
        stage.record();
      }
    }
    stage.step();
  }
  rehearsal.end = stage.seconds() < settings.longest ? supervisor.reason() : "the time was over";
  rehearsal.visits = supervisor.visits();
  rehearsal.trial = stage.take();
  if (rehearsal.trial.size() < 200)  // ten seconds
    throw InputError("the excitation ends as soon as it begins: " + rehearsal.end);
  return rehearsal;
}

Trial fly(const model::Vehicle& vehicle, const model::Model& model, bool by_wrench, const RehearsalSettings& settings,
          const excitation::Segment& segment, double duration) {
  const excitation::SupervisorSettings& s = settings.supervisor;
  excitation::FenceSettings room = s.fence;
  const Eigen::Vector3d start = start_in(room);
  for (Eigen::Index i = 0; i < 3; ++i) {
    if (!std::isfinite(room.low[i])) room.low[i] = start[i] - s.open_range;
    if (!std::isfinite(room.high[i])) room.high[i] = start[i] + s.open_range;
  }
  const excitation::Fence fence{room};
  Stage stage{vehicle, model, by_wrench, settings, start};
  excitation::Hold hold{s.hold, s.largest};
  std::array<bool, 6> held{};
  for (Eigen::Index axis = 0; axis < 6; ++axis) {
    held[static_cast<std::size_t>(axis)] = !segment.moves(axis) && axis != 3 && axis != 4;
  }
  double turned = 0.0;
  for (const double end = duration + kStep * kSample; stage.seconds() < end;) {
    const StateEstimate state = stage.state();
    if (stage.due()) {
      Vector6d tau = hold.step(state, turned, {start, 0.0}, held, kStep * kSample);
      tau += segment.at(std::fmod(stage.seconds(), segment.duration)).cwiseProduct(s.largest);
      stage.push(
          fence
              .bend(tau.cwiseMax(-s.largest).cwiseMin(s.largest), state, turned, s.hold.mass, s.hold.inertia, s.largest)
              .tau);
      stage.record();
    }
    turned += kStep * state.nu[5];
    stage.step();
  }
  return stage.take();
}

}  // namespace fathom::planning
