#include "common/likelihood/plant.hpp"

#include <algorithm>
#include <cmath>

#include "common/base/factors.hpp"

namespace fathom::likelihood {
namespace {

constexpr double kStreamStep = 1e-4;  // m/s, m/s^2, to both sides

bool moves_thrust(const Hypothesis& hypothesis, const Number& number) {
  if (number.kind == NumberKind::kCommandOffset) return true;
  return number.kind == NumberKind::kEffect &&
         stage_of(hypothesis.model.effects[static_cast<std::size_t>(number.index)]) == Stage::kThrust;
}

}  // namespace

Plant::Plant(const Hypothesis& hypothesis, const std::vector<Number>& numbers, const RunData& run,
             std::size_t run_index, bool with_columns)
    : model_{hypothesis.model},
      free_{hypothesis.force},
      own_{hypothesis.runs[run_index]},
      numbers_{numbers},
      run_{run},
      run_index_{run_index},
      memory_{model_, with_columns ? numbers : std::vector<Number>{}},
      slope_of_(numbers.size(), -1) {
  for (const model::ActiveEffect& active : model_.effects) stages_.push_back(stage_of(active));
  feels_ = std::ranges::find(stages_, Stage::kHull) != stages_.end();
  free_moves_ = std::ranges::any_of(free_.features, [](const Feature& f) { return f.moves_with_velocity(); });
  free_drags_ = free_.reads_drag();
  free_streams_ = free_.streams();
  free_weighs_ = std::ranges::any_of(free_.features, &Feature::weighs);
  features_.allocation = &model_.allocation;
  thrust_forces(model_, run_, own_.command_offset, forces_);
  mean_over_blocks(forces_, mean_);
  motion_.vehicle = model_.vehicle;
  if (!with_columns) return;
  Eigen::MatrixXd moved, mean;
  for (std::size_t j = 0; j < numbers.size(); ++j) {
    const Number& number = numbers[j];
    if (!moves_thrust(hypothesis, number)) continue;
    if (number.kind == NumberKind::kCommandOffset && number.run != static_cast<int>(run_index)) continue;
    Hypothesis other{.model = model_, .runs = hypothesis.runs};
    double& there = at(other, number);
    // Forward, or backward where the limit is near.
    const double step = there + number.step <= number.high ? number.step : -number.step;
    there += step;
    thrust_forces(other.model, run_, other.runs[run_index].command_offset, moved);
    mean_over_blocks(moved, mean);
    slope_of_[j] = static_cast<int>(slopes_.size());
    slopes_.emplace_back((mean - mean_) / step);
  }
}

void Plant::mean_over_blocks(const Eigen::MatrixXd& forces, Eigen::MatrixXd& mean) const {
  const auto& blocks = run_.blocks();
  mean.resize(forces.rows(), static_cast<Eigen::Index>(blocks.size()));
  for (std::size_t b = 0; b < blocks.size(); ++b) {
    const auto first = static_cast<Eigen::Index>(blocks[b].first) * run_.substeps();
    const auto count = static_cast<Eigen::Index>(blocks[b].last - blocks[b].first) * run_.substeps();
    mean.col(static_cast<Eigen::Index>(b)) = forces.middleCols(first, count).rowwise().mean();
  }
}

void Plant::set(const Interval& interval, double t) {
  motion_.t = t;
  motion_.p_WB = interval.p_WB;
  motion_.R_WB = interval.R_WB;
  motion_.nu_dot_told = interval.told_slope;
  motion_.voltage = interval.voltage;
  motion_.columns = interval.columns;
}

void Plant::begin(const Vector6d& nu) {
  if (run_.intervals().empty()) return;
  const Interval& first = run_.intervals().front();
  set(first, first.t);
  motion_.nu = nu;
  motion_.v_WF_B.setZero();
  motion_.a_WF_B.setZero();
  motion_.force = forces_.col(0);
  feel();
  if (!memory_.empty()) memory_.begin(motion_);
  for (auto& slow : features_.slow_nu) slow = motion_.nu_r();
  const Vector6d tau = model_.allocation * forces_.col(0);
  for (auto& slow : features_.slow_tau) slow = tau;
  for (auto& use : features_.use) use.setZero(forces_.rows());  // rested, as far as anyone knows
}

void Plant::at_substep(std::size_t interval, int substep) {
  const Interval& here = run_.intervals()[interval];
  set(here, here.t + (substep + 0.5 - 0.5 * run_.substeps()) * run_.h());
  force_ = forces_.col(static_cast<Eigen::Index>(interval) * run_.substeps() + substep);
  motion_.force = force_;
  if (!free_.empty()) show_features();
}

void Plant::show_features() {
  features_.t = motion_.t;
  features_.p_WB = motion_.p_WB;
  features_.R_WB = motion_.R_WB;
  const double across = std::hypot(motion_.R_WB(0, 0), motion_.R_WB(1, 0));
  features_.heading_cosine = across > 0.0 ? motion_.R_WB(0, 0) / across : 1.0;
  features_.heading_sine = across > 0.0 ? motion_.R_WB(1, 0) / across : 0.0;
  features_.columns = motion_.columns;
  features_.voltage = motion_.voltage;
  features_.force = force_;
  features_.tau = model_.allocation * force_;
  if (!free_.empty() && !free_moves_) free_still_ = free_.wrench(features_);
  if (free_weighs_) motion_.m_more = free_.mass(features_);
  if (!free_streams_) return;
  const model::Stream stream = free_.stream(features_);
  v_WF_B_ = motion_.R_WB.transpose() * stream.v_WF;
  a_WF_B_ = motion_.R_WB.transpose() * stream.a_WF;
}

void Plant::at_middle(std::size_t block) {
  const Block& here = run_.blocks()[block];
  const std::size_t interval = (here.first + here.last) / 2;
  const Interval& at = run_.intervals()[std::min(interval, run_.intervals().size() - 1)];
  const double middle = run_.trial().t[here.first] + 0.5 * here.dt;
  set(at, middle);
  force_ = mean_.col(static_cast<Eigen::Index>(block));
  motion_.force = force_;
  show_features();
}

void Plant::feel_at(const Vector6d& nu) {
  motion_.nu = nu;
  motion_.v_WF_B = v_WF_B_;
  motion_.a_WF_B = a_WF_B_;
  motion_.w_memory.setZero();
  motion_.force = force_;
  if (feels_) feel();
}

void Plant::feel() {
  for (std::size_t e = 0; e < stages_.size(); ++e) {
    const model::ActiveEffect& active = model_.effects[e];
    if (stages_[e] == Stage::kHull) active.effect->feel(motion_, active.theta, active.variant, {});
  }
}

Vector6d Plant::outside_wrench() {
  Vector6d wrench = memory_.empty() ? Vector6d{Vector6d::Zero()} : memory_.wrench();
  if (!own_.world_force.isZero(0.0)) wrench.head<3>() += motion_.R_WB.transpose() * own_.world_force;
  if (free_.empty()) return wrench;
  if (!free_moves_) return wrench + free_still_;
  features_.nu = motion_.nu_r();
  if (free_drags_) features_.drag = model::hull_drag(model_, features_.nu);
  return wrench + free_.wrench(features_);
}

FeatureState Plant::features_at(const Vector6d& nu, bool with_operators) {
  feel_at(nu);
  FeatureState state = features_;
  state.nu = motion_.nu_r();
  state.drag = model::hull_drag(model_, state.nu);
  if (!with_operators) return state;
  state.by_mass = model::held_back_by_mass(acceleration(nu), nu);
  model::Load load;
  const auto pushed = [&](const Eigen::Vector3d& faster, const Eigen::Vector3d& gaining) {
    model::Motion motion = motion_;
    motion.nu = nu;
    motion.v_WF_B = v_WF_B_ + faster;
    motion.a_WF_B = a_WF_B_ + gaining;
    motion.force = force_;
    feel_hull(model_, motion);
    return model::generalised_force(model_, motion, load);
  };
  for (Eigen::Index w = 0; w < 3; ++w) {
    const Eigen::Vector3d step = kStreamStep * motion_.R_WB.row(w).transpose();
    const Eigen::Vector3d none = Eigen::Vector3d::Zero();
    state.by_stream.col(w) = (pushed(step, none) - pushed(-step, none)) / (2.0 * kStreamStep);
    state.by_stream_rate.col(w) = (pushed(none, step) - pushed(none, -step)) / (2.0 * kStreamStep);
  }
  return state;
}

Vector6d Plant::acceleration(const Vector6d& nu) {
  feel_at(nu);
  motion_.w_memory += outside_wrench();
  return model::acceleration(model_, motion_);
}

Vector6d Plant::added_by(const model::ActiveEffect& effect, const Vector6d& nu_dot, const Matrix6d& inverse) {
  const Eigen::Vector3d v = motion_.v_WF_B, a = motion_.a_WF_B;
  const model::ActuatorForces force = motion_.force;
  effect.effect->feel(motion_, effect.theta, effect.variant, {});
  Vector6d there = nu_dot;
  if (motion_.v_WF_B != v || motion_.a_WF_B != a || motion_.force != force)
    there = model::acceleration(model_, motion_);
  model::Load load;
  load.drag = model::hull_drag(model_, motion_.nu_r());
  effect.effect->load(motion_, effect.theta, effect.variant, load);
  motion_.v_WF_B = v;
  motion_.a_WF_B = a;
  motion_.force = force;
  if (!load.has_inertia()) return there - nu_dot + inverse * load.wrench;
  // (M + m) x = M there + wrench, with axes that are not simulated as measured.
  const Matrix6d m = load.inertia();
  const Vector6d change = inverse * (load.wrench - m * (there + motion_.nu_dot_told));
  return there - nu_dot + InertiaFactor{Matrix6d::Identity() + inverse * m}.solve(change);
}

void Plant::end_block(std::size_t block, const Vector6d& nu) {
  const Block& here = run_.blocks()[block];
  Vector6d past = nu;
  if (feels_ || !memory_.empty()) {
    at_middle(block);
    feel_at(nu);
    past = motion_.nu_r();
    past.head<3>() += v_WF_B_;  // its own streams are felt after its memory
  }
  if (!memory_.empty()) memory_.advance(motion_, here.dt);
  const Vector6d tau = model_.allocation * mean_.col(static_cast<Eigen::Index>(block));
  for (std::size_t b = 0; b < kThrustMemories.size(); ++b)
    features_.slow_tau[b] += -std::expm1(-here.dt / kThrustMemories[b]) * (tau - features_.slow_tau[b]);
  for (std::size_t b = 0; b < kVelocityMemories.size(); ++b)
    features_.slow_nu[b] += -std::expm1(-here.dt / kVelocityMemories[b]) * (past - features_.slow_nu[b]);
  for (std::size_t b = 0; b < kUseMemories.size(); ++b)
    features_.use[b] += -std::expm1(-here.dt / kUseMemories[b]) *
                        (mean_.col(static_cast<Eigen::Index>(block)).cwiseAbs() - features_.use[b]);
}

}  // namespace fathom::likelihood
