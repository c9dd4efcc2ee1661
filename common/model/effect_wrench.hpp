// What one effect adds to the wrench along a measured motion, at given numbers, and how that changes with each of them.
#pragma once

#include <span>
#include <vector>

#include "common/model/dynamics.hpp"

namespace fathom::model {

/// Rows X..N; first column: at the numbers themselves; then one per number: change per unit of it; then, for an effect
/// that alters what the hull feels or multiplies its drag, one per base parameter asked for: change per unit of that.
using EffectColumns = Eigen::Matrix<double, 6, Eigen::Dynamic>;

class EffectWrench {
 public:
  /// `base` supplies drag and masses, for effects that alter what the hull feels or multiply its drag; its own effects
  /// are left out.
  EffectWrench(const Model& base, ActiveEffect effect, std::span<const BaseParameter> parameters = {});

  [[nodiscard]] const ActiveEffect& effect() const { return effect_; }
  [[nodiscard]] Eigen::Index columns() const {
    return 1 + static_cast<Eigen::Index>(effect_.theta.size() + moved_bases_.size());
  }
  [[nodiscard]] const Model& base() const { return base_; }
  /// Whether base parameters have columns.
  [[nodiscard]] bool felt() const { return !moved_bases_.empty(); }
  /// Memory settles at the next sample.
  void reset() { settled_ = false; }
  /// `motion` as commanded; `middle` is the command halfway since the last sample, `dt` s ago. `wrench` is added on the
  /// right-hand side; `momentum` (added inertia times nu) is what its rate takes from it.
  void step(const Motion& motion, const ActuatorForces& middle, double dt, Eigen::Ref<EffectColumns> wrench,
            Eigen::Ref<EffectColumns> momentum);

 private:
  struct Probe {  // the effect at its numbers, or with one of them moved
    std::vector<double> theta;
    std::vector<double> memory;
    double step{};
  };
  [[nodiscard]] Vector6d added(const Model& base, const Motion& motion, const Probe& probe, Motion& felt,
                               Load& load) const;

  Model base_;
  std::vector<Model> moved_bases_;  // with one parameter a unit larger: the wrench is linear in each
  ActiveEffect effect_;
  std::vector<Probe> probes_;
  bool settled_{false};
};

}  // namespace fathom::model
