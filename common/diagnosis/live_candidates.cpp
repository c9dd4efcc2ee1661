#include "common/diagnosis/live_candidates.hpp"

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>

#include "common/model/effect_size.hpp"
#include "common/model/hull_terms.hpp"

namespace fathom::diagnosis {
namespace {

constexpr double kStep = 3e-4;  // of the number or a tenth of its sigma, for differences: rounding and curvature small

// Of what sensors do, only an arm is asked here: scales of velocities hide in masses and drag, and what is late is no
// matter of an instant.
bool is_asked(const model::Effect& effect) { return !effect.measures() || effect.traits().asked_first; }

/// `nu` as it was, were `effect` in what measured it.
Vector6d unmeasured(const model::Effect& effect, Vector6d nu, std::span<const double> theta, int variant) {
  Eigen::Map<model::VelocityTrace> one{nu.data(), 6, 1};
  model::VelocityView view{one};
  effect.unmeasure(view, 0.0, theta, variant);
  return nu;
}

bool adds_inertia(const model::Effect& effect, int variant, const std::vector<double>& theta,
                  const model::Model& base) {
  if (effect.measures()) return true;  // other velocities are another momentum
  model::Motion motion;
  motion.vehicle = base.vehicle;
  motion.force = model::ActuatorForces::Zero(base.allocation.cols());
  model::Load load;
  effect.load(motion, theta, variant, load);
  return load.has_inertia();
}

}  // namespace

LiveCandidates::LiveCandidates(const model::Model& base, const model::Scene& scene) : base_{base} {
  base_.effects.clear();
  // STATE's places rest on the same sensors as its velocities: no witness of a wrong arm.
  model::Scene instruments = scene;
  instruments.position = instruments.attitude = false;
  for (const model::Effect* effect : model::all_effects()) {
    if (!is_asked(*effect)) continue;
    const std::vector<std::string> names = effect->variants(effect->measures() ? instruments : scene);
    for (std::size_t v = 0; v < names.size(); ++v) {
      if (names[v] == "-") continue;
      const auto variant = static_cast<int>(v);
      LiveForm form{effect, variant, names[v], model::parameters_of(*effect, variant, *base_.vehicle)};
      for (std::size_t i = 0; i < form.parameters.size(); ++i) {
        if (effect->takes_part(variant, i)) form.sought.push_back(i);
      }
      forms_.push_back(std::move(form));
      for (const auto& theta : effect->starts(scene, variant)) add(static_cast<int>(forms_.size()) - 1, theta);
    }
  }
  for (Eigen::Index k = 0; k < kTurns; ++k) inertial_.push_back(columns_ + k);
}

void LiveCandidates::add(int form, const std::vector<double>& theta) {
  const LiveForm& f = forms_[static_cast<std::size_t>(form)];
  const auto& parameters = f.parameters;
  const auto memory =
      static_cast<std::size_t>(f.effect->state_size(*base_.vehicle, static_cast<int>(base_.allocation.cols())));
  const LiveStart start{
      .form = form, .theta = theta, .column = columns_, .sought = static_cast<Eigen::Index>(f.sought.size())};
  Probe probe{.effect = f.effect,
              .variant = f.variant,
              .column = columns_,
              .per_step = 0.0,
              .theta = theta,
              .memory = std::vector<double>(memory, 0.0)};
  probes_.push_back(probe);
  for (const std::size_t i : f.sought) {
    double step = kStep * std::max(std::abs(theta[i]), 0.1 * parameters[i].sigma);
    if (theta[i] + step > parameters[i].high) step = -step;
    probe.theta = theta;
    probe.theta[i] += step;
    probe.per_step = parameters[i].sigma / step;
    ++probe.column;
    probes_.push_back(probe);
  }
  const bool inertia = adds_inertia(*f.effect, f.variant, theta, base_);
  for (Eigen::Index c = 0; c < start.columns(); ++c) {
    momentum_of_.push_back(inertia ? static_cast<Eigen::Index>(inertial_.size()) : -1);
    if (inertia) inertial_.push_back(columns_ + c);
  }
  columns_ += start.columns();
  starts_.push_back(start);
}

void LiveCandidates::step(const model::Motion& motion, const model::ActuatorForces& middle, double dt,
                          Eigen::Ref<WrenchColumns> wrench, Eigen::Ref<WrenchColumns> momentum) {
  model::Load load;
  const model::HullTerms hull{base_, motion};
  const Vector6d absent = model::generalised_force(base_, motion, hull, load);
  model::Motion halfway = motion;
  halfway.t -= 0.5 * dt;
  halfway.force = middle;
  model::Motion felt = motion;
  Vector6d at_start = Vector6d::Zero();
  Vector6d momentum_at_start = Vector6d::Zero();
  for (Probe& probe : probes_) {
    if (!probe.memory.empty()) {
      if (settled_) {
        probe.effect->advance(halfway, probe.theta, probe.variant, dt, probe.memory);
      } else {
        probe.effect->settle(motion, probe.theta, probe.variant, probe.memory);
      }
    }
    felt.nu = probe.effect->measures() ? unmeasured(*probe.effect, motion.nu, probe.theta, probe.variant) : motion.nu;
    felt.v_WF_B = motion.v_WF_B;  // and all else that feel() may alter
    felt.a_WF_B = motion.a_WF_B;
    felt.w_memory = motion.w_memory;
    felt.force = motion.force;
    probe.effect->feel(felt, probe.theta, probe.variant, probe.memory);
    // Most alter no more than thrust, and there are a thousand of them.
    const bool as_hull = !probe.effect->measures() && !model::water_moves(felt);
    const Vector6d force = as_hull ? model::generalised_force(base_, felt, hull, load)  //
                                   : model::generalised_force(base_, felt, load);
    probe.effect->load(felt, probe.theta, probe.variant, load);
    const Vector6d total = force + load.wrench;
    const bool is_start = probe.per_step == 0.0;
    if (is_start) at_start = total;
    wrench.col(probe.column) = is_start ? Vector6d{total - absent} : Vector6d{(total - at_start) * probe.per_step};
    const Eigen::Index entry = momentum_of_[static_cast<std::size_t>(probe.column)];
    if (entry < 0) continue;
    const Vector6d added = probe.effect->measures() ? base_.theta.head<6>().cwiseProduct(felt.nu - motion.nu).eval()
                                                    : Vector6d{load.inertia() * motion.nu};
    if (is_start) momentum_at_start = added;
    momentum.col(entry) = is_start ? added : Vector6d{(added - momentum_at_start) * probe.per_step};
  }
  turn(motion, absent, wrench, momentum);
  settled_ = true;
}

void LiveCandidates::turn(const model::Motion& motion, const Vector6d& absent, Eigen::Ref<WrenchColumns> wrench,
                          Eigen::Ref<WrenchColumns> momentum) const {
  constexpr double kTurn = 1e-3;  // rad: curvature and rounding small
  model::Load load;
  model::Motion felt = motion;
  for (Eigen::Index k = 0; k < kTurns; ++k) {
    const Eigen::Vector3d error = Eigen::Vector3d::Unit(k).cross(motion.nu.tail<3>());
    felt.nu.tail<3>() = motion.nu.tail<3>() - kTurn * error;
    wrench.col(columns_ + k) = (model::generalised_force(base_, felt, load) - absent) / kTurn;
    momentum.col(momentum.cols() - kTurns + k) = base_.theta.head<6>().cwiseProduct(felt.nu - motion.nu) / kTurn;
  }
}

}  // namespace fathom::diagnosis
