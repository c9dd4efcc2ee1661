#include "common/likelihood/effect_stages.hpp"

#include <algorithm>
#include <cmath>

#include "common/model/effect_size.hpp"
#include "common/model/onset.hpp"
#include "common/model/rollout.hpp"

namespace fathom::likelihood {
namespace {

constexpr double kDifference = 1e-4;     // of a memory's number, for its derivative
constexpr double kLongestLatency = 0.6;  // s of velocities that a late sensor may still show
constexpr double kOnsetSigma = 0.5;      // of the data's length

int actuators(const model::Model& model) { return static_cast<int>(model.allocation.cols()); }

std::size_t memory_of(const model::Model& model, const model::ActiveEffect& active) {
  return static_cast<std::size_t>(active.effect->state_size(*model.vehicle, actuators(model)));
}

}  // namespace

Stage stage_of(const model::ActiveEffect& active) {
  if (model::changes_thrust(*active.effect)) return Stage::kThrust;
  if (active.effect->measures()) return Stage::kSensor;
  return active.effect->remembers_motion() ? Stage::kMemory : Stage::kHull;
}

bool has_stage(const model::Model& model, Stage stage) {
  return std::ranges::any_of(model.effects, [&](const auto& active) { return stage_of(active) == stage; });
}

void add_effect_numbers(const model::Model& model, std::size_t effect, double t_low, double t_high,
                        std::vector<Number>& numbers) {
  const model::ActiveEffect& active = model.effects[effect];
  for (std::size_t c = 0; c < active.theta.size(); ++c) {
    if (!active.effect->takes_part(active.variant, c)) continue;
    const model::EffectParameter parameter = model::parameter_of(*active.effect, active.variant, c, *model.vehicle);
    Number number{.kind = NumberKind::kEffect,
                  .index = static_cast<int>(effect),
                  .component = static_cast<int>(c),
                  .name = std::string(active.effect->name()) + "." + std::string(parameter.name),
                  .unit = std::string(active.effect->unit(active.variant, c)),
                  .sigma = parameter.sigma,
                  .freedom = kEffectFreedom,
                  .low = parameter.low,
                  .high = parameter.high};
    if (parameter.name == model::kOnset) {  // a time: anywhere in the data
      number.mean = 0.5 * (t_low + t_high);
      number.sigma = kOnsetSigma * (t_high - t_low);
      number.low = t_low;
      number.high = t_high;
      number.freedom = 0.0;
      number.step = 0.02;
    }
    if (parameter.after_command) number.step = 1e-3;  // a time: commands are straight lines between samples
    numbers.push_back(std::move(number));
  }
}

void thrust_forces(const model::Model& model, const RunData& run, double offset, Eigen::MatrixXd& forces) {
  const Trial& trial = run.trial();
  model::InputSignal input = model::input_of(model, trial);
  input.act_later(offset);  // for what effects look up as well
  std::vector<const model::ActiveEffect*> chain;
  std::vector<std::size_t> sizes;
  std::size_t size = 0;
  for (const model::ActiveEffect& active : model.effects) {
    if (stage_of(active) != Stage::kThrust) continue;
    chain.push_back(&active);
    sizes.push_back(memory_of(model, active));
    size += sizes.back();
  }
  std::vector<double> memory(size, 0.0);
  model::Motion motion;
  motion.input = &input;
  motion.vehicle = model.vehicle;
  const std::size_t intervals = run.intervals().size();
  const int substeps = run.substeps();
  forces.resize(model.allocation.cols(), static_cast<Eigen::Index>(intervals) * substeps);
  if (intervals == 0) return;
  const auto through = [&](double dt, bool settle) {
    std::size_t at = 0;
    for (std::size_t e = 0; e < chain.size(); ++e) {
      const std::span<double> z{memory.data() + at, sizes[e]};
      const model::ActiveEffect& active = *chain[e];
      if (settle) active.effect->settle(motion, active.theta, active.variant, z);
      if (!settle && dt > 0.0 && sizes[e] > 0) active.effect->advance(motion, active.theta, active.variant, dt, z);
      active.effect->feel(motion, active.theta, active.variant, z);
      at += sizes[e];
    }
  };
  motion.t = trial.t.front();
  motion.voltage = run.intervals().front().voltage;
  input.now(motion.t, motion.force);
  if (size > 0) through(0.0, true);
  const double h = run.h();
  for (std::size_t k = 0; k < intervals; ++k) {
    motion.voltage = run.intervals()[k].voltage;
    for (int s = 0; s < substeps; ++s) {
      motion.t = trial.t[k] + (s + 0.5) * h;
      input.now(motion.t, motion.force);
      const model::ActuatorForces commanded = motion.force;
      through(0.5 * h, false);
      forces.col(static_cast<Eigen::Index>(k) * substeps + s) = motion.force;
      if (size == 0) continue;
      motion.force = commanded;
      through(0.5 * h, false);
    }
  }
}

void feel_hull(const model::Model& model, model::Motion& motion) {
  for (const model::ActiveEffect& active : model.effects) {
    if (stage_of(active) == Stage::kHull) active.effect->feel(motion, active.theta, active.variant, {});
  }
}

MotionMemory::MotionMemory(const model::Model& model, const std::vector<Number>& numbers)
    : slopes_(numbers.size(), Vector6d::Zero()), slope_of_(numbers.size(), 0) {
  for (std::size_t e = 0; e < model.effects.size(); ++e) {
    const model::ActiveEffect& active = model.effects[e];
    if (stage_of(active) != Stage::kMemory) continue;
    Part part{.active = &active, .size = memory_of(model, active)};
    part.itself = {active.theta, std::vector<double>(part.size, 0.0)};
    for (std::size_t j = 0; j < numbers.size(); ++j) {
      if (numbers[j].kind != NumberKind::kEffect || static_cast<std::size_t>(numbers[j].index) != e) continue;
      const auto c = static_cast<std::size_t>(numbers[j].component);
      const double step = kDifference * std::max(std::abs(active.theta[c]), 0.01 * numbers[j].sigma);
      part.moved.push_back(part.itself);
      part.moved.back().theta[c] += step;
      part.number.push_back(j);
      part.step.push_back(step);
      slope_of_[j] = 1;
    }
    part.columns.assign(part.size * numbers.size(), 0.0);
    parts_.push_back(std::move(part));
  }
}

void MotionMemory::advance(const model::Motion& motion, const Part& part, double dt, Copy& copy) {
  const model::ActiveEffect& active = *part.active;
  if (dt > 0.0) {
    active.effect->advance(motion, copy.theta, active.variant, dt, copy.z);
  } else {
    active.effect->settle(motion, copy.theta, active.variant, copy.z);
  }
  model::Motion felt;
  felt.vehicle = motion.vehicle;
  active.effect->feel(felt, copy.theta, active.variant, copy.z);
  // Half a block ahead of now, along the last block's slope.
  copy.next = dt > 0.0 ? Vector6d{felt.w_memory + 0.5 * (felt.w_memory - copy.now)} : felt.w_memory;
  copy.now = felt.w_memory;
}

void MotionMemory::begin(const model::Motion& motion) {
  for (Part& part : parts_) std::ranges::fill(part.columns, 0.0);
  advance(motion, 0.0);
}

void MotionMemory::advance(const model::Motion& motion, double dt) {
  wrench_.setZero();
  for (Part& part : parts_) {
    advance(motion, part, dt, part.itself);
    wrench_ += part.itself.next;
    for (std::size_t m = 0; m < part.moved.size(); ++m) {
      advance(motion, part, dt, part.moved[m]);
      slopes_[part.number[m]] = (part.moved[m].next - part.itself.next) / part.step[m];
    }
  }
}

const Vector6d* MotionMemory::slope(std::size_t j) const { return slope_of_[j] != 0 ? &slopes_[j] : nullptr; }

void MotionMemory::advance_columns(const model::Motion& motion, double dt,
                                   const Eigen::Matrix<double, 6, Eigen::Dynamic>& nu_columns,
                                   Eigen::Matrix<double, 6, Eigen::Dynamic>& wrenches) {
  model::Motion change;
  change.vehicle = motion.vehicle;
  for (Part& part : parts_) {
    const model::ActiveEffect& active = *part.active;
    for (Eigen::Index j = 0; j < nu_columns.cols(); ++j) {
      change.nu = nu_columns.col(j);
      change.w_memory.setZero();
      const std::span<double> z{part.columns.data() + static_cast<std::size_t>(j) * part.size, part.size};
      active.effect->advance(change, active.theta, active.variant, dt, z);
      active.effect->feel(change, active.theta, active.variant, z);
      wrenches.col(j) += change.w_memory;
    }
  }
}

SensorStage::SensorStage(const model::Model& model, double dt) : empty_{!has_stage(model, Stage::kSensor)}, dt_{dt} {
  if (empty_) return;
  const auto samples = static_cast<Eigen::Index>(std::ceil(kLongestLatency / dt)) + 4;
  trace_.setZero(6, samples);
  shown_ = trace_;
}

void SensorStage::begin(const Vector6d& nu) {
  if (!empty_) trace_.colwise() = nu;
}

void SensorStage::push(const Vector6d& nu) {
  if (empty_) return;
  for (Eigen::Index k = 0; k + 1 < trace_.cols(); ++k) trace_.col(k) = trace_.col(k + 1);
  trace_.col(trace_.cols() - 1) = nu;
}

Vector6d SensorStage::mean(std::size_t samples, const model::Model& model) {
  shown_ = trace_;
  model::VelocityView view{shown_};
  for (const model::ActiveEffect& active : model.effects) {
    if (stage_of(active) == Stage::kSensor) active.effect->measure(view, dt_, active.theta, active.variant);
  }
  return shown_.rightCols(static_cast<Eigen::Index>(samples)).rowwise().mean();
}

Matrix6d SensorStage::slope(const model::Model& model, double dt) {
  Matrix6d slope;
  for (Eigen::Index i = 0; i < 6; ++i) {
    model::VelocityTrace unit = Vector6d::Unit(i);
    model::VelocityView view{unit};
    for (const model::ActiveEffect& active : model.effects) {
      if (stage_of(active) == Stage::kSensor) active.effect->measure(view, dt, active.theta, active.variant);
    }
    slope.col(i) = unit;
  }
  return slope;
}

}  // namespace fathom::likelihood
