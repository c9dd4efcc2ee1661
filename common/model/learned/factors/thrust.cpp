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
std::string of_one(const char* letter, const Factor& f) {
  return letter + (f.index == kOwn ? std::string{"j"} : std::to_string(f.index + 1));
}
std::string thruster(const Factor& f) { return of_one("f_", f); }

/// Speed of the water along a thruster's line, as the thruster moves with the hull, m/s.
double advance(const Factor& f, const FeatureState& s) {
  if (s.allocation == nullptr || f.index >= s.allocation->cols()) return 0.0;
  const auto line = s.allocation->col(f.index);
  const double length = line.head<3>().norm();
  return length > 0.0 ? line.dot(s.nu) / length : 0.0;
}
double advance_within(const Factor& f, const FeatureState& s, const Visited& visited) {
  if (s.allocation == nullptr || f.index >= s.allocation->cols()) return 1.0;
  const auto line = s.allocation->col(f.index);
  const double length = line.head<3>().norm();
  return length > 0.0 ? fade_beyond(advance(f, s), line.cwiseAbs().dot(visited.nu) / length) : 1.0;
}

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

constinit const FactorKind factor_thruster_root{
    .word = "thruster_root",
    .sentence = "the root of the size of one thruster's force, as its shaft speed goes",
    .unit = "N^(1/2)",
    .indexed = Indexed::kThrusters,
    .value = [](const Factor& f, const FeatureState& s) { return std::sqrt(std::abs(s.force[f.index])); },
    .words = [](const Factor& f) { return "|" + thruster(f) + "|^(1/2)"; },
    .within = of_thruster};

// A hat over the size of the force: 1 at a [N], 0 from b [N] below and from c [N] above on.
constinit const FactorKind factor_thrust_knot{
    .word = "thrust_knot",
    .sentence = "whether one thruster's force is about a size, with its sign",
    .unit = "1",
    .indexed = Indexed::kThrusters,
    .value =
        [](const Factor& f, const FeatureState& s) {
          const double off = std::abs(s.force[f.index]) - f.a;
          return std::copysign(std::max(0.0, 1.0 - (off < 0.0 ? -off / f.b : off / f.c)), s.force[f.index]);
        },
    .words =
        [](const Factor& f) {
          return "sign(" + thruster(f) + ") hat(|" + thruster(f) + "|, " + brief_number(f.a) + " N)";
        },
    .within = of_thruster};

constinit const FactorKind factor_thrust_below{
    .word = "thrust_below",
    .sentence = "one thruster's force where it is smaller than a size a [N], else nothing",
    .unit = "N",
    .indexed = Indexed::kThrusters,
    .value = [](const Factor& f,
                const FeatureState& s) { return std::abs(s.force[f.index]) < f.a ? s.force[f.index] : 0.0; },
    .words = [](const Factor& f) { return thruster(f) + " 1(|" + thruster(f) + "| < " + brief_number(f.a) + " N)"; },
    .within = of_thruster};

constinit const FactorKind factor_thrust_held{
    .word = "thrust_held",
    .sentence = "one thruster's force, no larger than a size a [N]",
    .unit = "N",
    .indexed = Indexed::kThrusters,
    .value = [](const Factor& f, const FeatureState& s) { return std::clamp(s.force[f.index], -f.a, f.a); },
    .words =
        [](const Factor& f) {
          return "sign(" + thruster(f) + ") min(|" + thruster(f) + "|, " + brief_number(f.a) + " N)";
        },
    .within = of_thruster};

constinit const FactorKind factor_advance{.word = "advance",
                                          .sentence = "the speed at which one thruster advances along its line",
                                          .unit = "m/s",
                                          .indexed = Indexed::kThrusters,
                                          .moves = true,
                                          .value = advance,
                                          .words = [](const Factor& f) { return of_one("u_a", f); },
                                          .within = advance_within};

constinit const FactorKind factor_advance_size{
    .word = "advance_size",
    .sentence = "the size of the speed at which one thruster advances along its line",
    .unit = "m/s",
    .indexed = Indexed::kThrusters,
    .moves = true,
    .value = [](const Factor& f, const FeatureState& s) { return std::abs(advance(f, s)); },
    .words = [](const Factor& f) { return "|" + of_one("u_a", f) + "|"; },
    .within = advance_within};

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
