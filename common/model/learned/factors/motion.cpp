// Factors that read the velocity.
#include "common/model/learned/factors/factor_kind.hpp"

namespace fathom::model {
namespace {

double of_axis(const Factor& f, const FeatureState& s, const Visited& visited) {
  return fade_beyond(s.nu[f.index], visited.nu[f.index]);
}
std::string nu(const Factor& f) { return axis_name(kNuNames, f.index); }

}  // namespace

constinit const FactorKind factor_velocity{
    .word = "velocity",
    .sentence = "a velocity",
    .unit = "m/s or rad/s",
    .indexed = Indexed::kAxes,
    .moves = true,
    .value = [](const Factor& f, const FeatureState& s) { return s.nu[f.index]; },
    .words = nu,
    .within = of_axis};

constinit const FactorKind factor_speed{
    .word = "speed",
    .sentence = "the size of a velocity",
    .unit = "m/s or rad/s",
    .indexed = Indexed::kAxes,
    .moves = true,
    .value = [](const Factor& f, const FeatureState& s) { return std::abs(s.nu[f.index]); },
    .words = [](const Factor& f) { return "|" + nu(f) + "|"; },
    .within = of_axis};

constinit const FactorKind factor_power_odd{
    .word = "power_odd",
    .sentence = "a power of a velocity, its sign kept",
    .unit = "(m/s)^n or (rad/s)^n",
    .indexed = Indexed::kAxes,
    .moves = true,
    .value = [](const Factor& f,
                const FeatureState& s) { return std::copysign(std::pow(std::abs(s.nu[f.index]), f.a), s.nu[f.index]); },
    .words = [](const Factor& f) { return "sign(" + nu(f) + ") |" + nu(f) + "|^" + brief_number(f.a); },
    .within = of_axis};

constinit const FactorKind factor_power_even{
    .word = "power_even",
    .sentence = "a power of the size of a velocity",
    .unit = "(m/s)^n or (rad/s)^n",
    .indexed = Indexed::kAxes,
    .moves = true,
    .value = [](const Factor& f, const FeatureState& s) { return std::pow(std::abs(s.nu[f.index]), f.a); },
    .words = [](const Factor& f) { return "|" + nu(f) + "|^" + brief_number(f.a); },
    .within = of_axis};

constinit const FactorKind factor_flow_speed{
    .word = "flow_speed",
    .sentence = "the speed past the water, u, v and w together",
    .unit = "m/s",
    .moves = true,
    .value = [](const Factor&, const FeatureState& s) { return s.nu.head<3>().norm(); },
    .words = [](const Factor&) { return std::string{"U"}; },
    .within = [](const Factor&, const FeatureState& s,
                 const Visited& visited) { return fade_beyond(s.nu.head<3>().norm(), visited.nu.head<3>().norm()); }};

constinit const FactorKind factor_slow_velocity{
    .word = "slow_velocity",
    .sentence = "a velocity as it was a moment ago",
    .unit = "m/s or rad/s",
    .indexed = Indexed::kAxes,
    .banks = static_cast<int>(kVelocityMemories.size()),
    .value = [](const Factor& f,
                const FeatureState& s) { return s.slow_nu[static_cast<std::size_t>(f.bank)][f.index]; },
    .words =
        [](const Factor& f) {
          return nu(f) + " of the last " + brief_number(kVelocityMemories[static_cast<std::size_t>(f.bank)]) + " s";
        },
    .within =
        [](const Factor& f, const FeatureState& s, const Visited& visited) {
          return fade_beyond(s.slow_nu[static_cast<std::size_t>(f.bank)][f.index], visited.nu[f.index]);
        }};

}  // namespace fathom::model
