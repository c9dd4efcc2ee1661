// A free force as a part of a model: predictions, the simulator and reports meet it as they meet any effect, while the
// list of effects does not hold it. Beyond what its recording has visited it fades, and what of it goes with the
// velocity never gives the hull more power than its drag takes.
#pragma once

#include "common/model/effect.hpp"
#include "common/model/learned/features.hpp"

namespace fathom::model {

class LearnedForm final : public Form {
 public:
  LearnedForm(FreeForce force, Visited visited, Allocation allocation);

  [[nodiscard]] FormName name(const Scene&) const override { return {}; }  // it is no candidate
  void feel(Motion& motion, EffectTheta, std::span<const double> z) const override;
  void load(const Motion& motion, EffectTheta, Load& load) const override;
  [[nodiscard]] int state_size(int) const override;
  void settle(const Motion& motion, EffectTheta, std::span<double> z) const override;
  void advance(const Motion& motion, EffectTheta, double dt, std::span<double> z) const override;
  [[nodiscard]] double run_in(EffectTheta) const override;

  [[nodiscard]] const FreeForce& force() const { return force_; }
  [[nodiscard]] const Visited& visited() const { return visited_; }
  /// Whether some term fades there; what is remembered apart.
  [[nodiscard]] bool beyond(const Motion& motion) const;

 private:
  enum class Part { kStreams, kWeighs, kRemembers, kMoves, kStill };
  [[nodiscard]] FeatureState state_of(const Motion& motion) const;
  [[nodiscard]] FeatureState inside(const FeatureState& state) const;
  [[nodiscard]] Vector6d sum(const FeatureState& state, Part part) const;
  [[nodiscard]] static double fade(const Feature& feature, const FeatureState& state, const Visited& visited);

  FreeForce force_;
  std::vector<Part> part_;  // of each feature
  Visited visited_;         // by the recording
  Visited believed_;        // where sizes, times kVisitedReach, are taken at their word
  Allocation allocation_;
  bool remembers_{false}, streams_{false};
};

class LearnedForce final : public Effect {
 public:
  LearnedForce(FreeForce force, Visited visited, Allocation allocation);
  [[nodiscard]] const FreeForce& force() const { return learned().force(); }
  [[nodiscard]] const Visited& visited() const { return learned().visited(); }
  [[nodiscard]] bool beyond(const Motion& motion) const { return learned().beyond(motion); }

 private:
  [[nodiscard]] const LearnedForm& learned() const { return static_cast<const LearnedForm&>(form(0)); }
};

/// The part of a force for which `keep(group, feature)` holds; groups without features go.
template <typename Keep>
[[nodiscard]] FreeForce kept_of(const FreeForce& force, const Keep& keep) {
  FreeForce rest;
  for (const FeatureGroup& group : force.groups) {
    FeatureGroup kept = group;
    kept.first = static_cast<int>(rest.features.size());
    for (int j = group.first; j < group.first + group.count; ++j) {
      const auto at = static_cast<std::size_t>(j);
      if (!keep(group, force.features[at])) continue;
      rest.features.push_back(force.features[at]);
      rest.weights.push_back(force.weights[at]);
    }
    kept.count = static_cast<int>(rest.features.size()) - kept.first;
    if (kept.count > 0) rest.groups.push_back(std::move(kept));
  }
  return rest;
}

/// Whether all of it is a law in closed form that can still be read: its equation is told.
[[nodiscard]] bool is_law(const FreeForce& force);

/// Whether some law of it swings.
[[nodiscard]] bool swings(const FreeForce& force);

/// A force without what depends on time: what another run may be told. Empty where nothing else is in it.
[[nodiscard]] FreeForce without_time(const FreeForce& force);

/// What a run whose clock begins anew may be told: besides that, laws that grow with a run's time or set in at a
/// moment, on that run's own clock, as listed effects are.
[[nodiscard]] FreeForce lasting_of(const FreeForce& force);
/// The same as it stands at time `t` for good: what has begun goes on, what has grown stays as large, what swings goes
/// on in its phase. Tables over time, which tell of their own recording alone, are left out.
[[nodiscard]] FreeForce as_it_stands(const FreeForce& force, double t);

}  // namespace fathom::model
