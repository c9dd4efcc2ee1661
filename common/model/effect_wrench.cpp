#include "common/model/effect_wrench.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace fathom::model {
namespace {

constexpr double kStep = 1e-3;  // of the number or a tenth of its sigma, for differences: rounding and curvature small

}  // namespace

EffectWrench::EffectWrench(const Model& base, ActiveEffect effect, std::span<const BaseParameter> parameters)
    : base_{base}, effect_{std::move(effect)} {
  base_.effects.clear();
  if (effect_.effect->feels_motion() || effect_.effect->multiplies_drag(effect_.variant)) {
    for (const BaseParameter parameter : parameters) {
      moved_bases_.push_back(base_);
      moved_bases_.back().theta[index(parameter)] += 1.0;
    }
  }
  const auto numbers = effect_.effect->parameters();
  const auto memory =
      static_cast<std::size_t>(effect_.effect->state_size(*base_.vehicle, static_cast<int>(base_.allocation.cols())));
  probes_.assign(effect_.theta.size() + 1, {.theta = effect_.theta, .memory = std::vector<double>(memory, 0.0)});
  for (std::size_t i = 0; i < effect_.theta.size(); ++i) {
    double step = kStep * std::max(std::abs(effect_.theta[i]), 0.1 * numbers[i].sigma);
    if (effect_.theta[i] + step > numbers[i].high) step = -step;
    probes_[i + 1].step = step;
    if (effect_.effect->takes_part(effect_.variant, i)) probes_[i + 1].theta[i] += step;
  }
}

// The wrench with the effect less that without it.
Vector6d EffectWrench::added(const Model& base, const Motion& motion, const Probe& probe, Motion& felt,
                             Load& load) const {
  const Vector6d absent = generalised_force(base, motion, load);
  felt = motion;
  effect_.effect->feel(felt, probe.theta, effect_.variant, probe.memory);
  const Vector6d present = generalised_force(base, felt, load);
  effect_.effect->load(felt, probe.theta, effect_.variant, load);
  return present + load.wrench - absent;
}

void EffectWrench::step(const Motion& motion, const ActuatorForces& middle, double dt, Eigen::Ref<EffectColumns> wrench,
                        Eigen::Ref<EffectColumns> momentum) {
  Motion halfway = motion;
  halfway.t -= 0.5 * dt;
  halfway.force = middle;
  Motion felt;
  Load load;
  for (std::size_t i = 0; i < probes_.size(); ++i) {
    Probe& probe = probes_[i];
    if (i > 0 && !effect_.effect->takes_part(effect_.variant, i - 1)) {
      wrench.col(static_cast<Eigen::Index>(i)).setZero();
      momentum.col(static_cast<Eigen::Index>(i)).setZero();
      continue;
    }
    if (!probe.memory.empty()) {
      if (settled_) {
        effect_.effect->advance(halfway, probe.theta, effect_.variant, dt, probe.memory);
      } else {
        effect_.effect->settle(motion, probe.theta, effect_.variant, probe.memory);
      }
    }
    const Vector6d total = added(base_, motion, probe, felt, load);
    const Vector6d carried = load.has_inertia() ? Vector6d{load.inertia() * motion.nu} : Vector6d{Vector6d::Zero()};
    const auto column = static_cast<Eigen::Index>(i);
    if (i == 0) {
      wrench.col(0) = total;
      momentum.col(0) = carried;
    } else {
      wrench.col(column) = (total - wrench.col(0)) / probe.step;
      momentum.col(column) = (carried - momentum.col(0)) / probe.step;
    }
  }
  const auto bases = static_cast<Eigen::Index>(moved_bases_.size());
  for (Eigen::Index i = 0; i < bases; ++i) {
    const Vector6d total = added(moved_bases_[static_cast<std::size_t>(i)], motion, probes_.front(), felt, load);
    wrench.col(static_cast<Eigen::Index>(probes_.size()) + i) = total - wrench.col(0);
  }
  momentum.rightCols(bases).setZero();
  settled_ = true;
}

}  // namespace fathom::model
