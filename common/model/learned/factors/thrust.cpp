// Factors that read what the actuators do.
#include "common/model/learned/factors/factor_kind.hpp"

namespace fathom::model {
namespace {

double of_axis(const Factor& f, const FeatureState& s, const Visited& visited) {
  return fade_beyond(s.tau[f.index], visited.tau[f.index]);
}
double of_thruster(const Factor& f, const FeatureState& s, const Visited& visited) {
  return fade_beyond(s.force[f.index], visited.force[f.index]);
}
std::string tau(const Factor& f) { return "tau_" + axis_name(kTauNames, f.index); }
std::string thruster(const Factor& f) { return "f_" + std::to_string(f.index + 1); }

}  // namespace

constinit const FactorKind factor_wrench{.word = "wrench",
                                         .sentence = "the applied thrust along an axis",
                                         .unit = "N or N m",
                                         .indexed = Indexed::kAxes,
                                         .value = [](const Factor& f, const FeatureState& s) { return s.tau[f.index]; },
                                         .words = tau,
                                         .within = of_axis};

constinit const FactorKind factor_wrench_size{
    .word = "wrench_size",
    .sentence = "the size of the applied thrust along an axis",
    .unit = "N or N m",
    .indexed = Indexed::kAxes,
    .value = [](const Factor& f, const FeatureState& s) { return std::abs(s.tau[f.index]); },
    .words = [](const Factor& f) { return "|" + tau(f) + "|"; },
    .within = of_axis};

constinit const FactorKind factor_slow_wrench{
    .word = "slow_wrench",
    .sentence = "the applied thrust along an axis as it was a moment ago",
    .unit = "N or N m",
    .indexed = Indexed::kAxes,
    .banks = static_cast<int>(kThrustMemories.size()),
    .value = [](const Factor& f,
                const FeatureState& s) { return s.slow_tau[static_cast<std::size_t>(f.bank)][f.index]; },
    .words =
        [](const Factor& f) {
          return tau(f) + " of the last " + brief_number(kThrustMemories[static_cast<std::size_t>(f.bank)]) + " s";
        },
    .within =
        [](const Factor& f, const FeatureState& s, const Visited& visited) {
          return fade_beyond(s.slow_tau[static_cast<std::size_t>(f.bank)][f.index], visited.tau[f.index]);
        }};

constinit const FactorKind factor_thruster{
    .word = "thruster",
    .sentence = "the force of one thruster",
    .unit = "N",
    .indexed = Indexed::kThrusters,
    .value = [](const Factor& f, const FeatureState& s) { return s.force[f.index]; },
    .words = thruster,
    .within = of_thruster};

constinit const FactorKind factor_thruster_size{
    .word = "thruster_size",
    .sentence = "the size of the force of one thruster",
    .unit = "N",
    .indexed = Indexed::kThrusters,
    .value = [](const Factor& f, const FeatureState& s) { return std::abs(s.force[f.index]); },
    .words = [](const Factor& f) { return "|" + thruster(f) + "|"; },
    .within = of_thruster};

constinit const FactorKind factor_recent_use{
    .word = "recent_use",
    .sentence = "how much one thruster has pushed lately, either way",
    .unit = "N",
    .indexed = Indexed::kThrusters,
    .banks = static_cast<int>(kUseMemories.size()),
    .value =
        [](const Factor& f, const FeatureState& s) {
          const ActuatorForces& use = s.use[static_cast<std::size_t>(f.bank)];
          return f.index < use.size() ? use[f.index] : 0.0;
        },
    .words =
        [](const Factor& f) {
          return "|" + thruster(f) + "| of the last " + brief_number(kUseMemories[static_cast<std::size_t>(f.bank)]) +
                 " s";
        },
    .within =
        [](const Factor& f, const FeatureState& s, const Visited& visited) {
          const ActuatorForces& use = s.use[static_cast<std::size_t>(f.bank)];
          return f.index < use.size() ? fade_beyond(use[f.index], visited.force[f.index]) : 1.0;
        }};

}  // namespace fathom::model
