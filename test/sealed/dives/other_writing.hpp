// What the owner of a craft that is no ROV writes: actuators and commands instead of thrusters and forces.
#pragma once

#include "test/sealed/dives/sealed_set.hpp"

namespace fathom::sealed {

/// Density that the owner's file states [kg/m^3].
[[nodiscard]] double owners_density(const Craft& craft);
/// Whether commands are logged (shaft speeds, angles, volumes), not forces: then a column map goes with the data.
[[nodiscard]] bool logs_commands(const Craft& craft);
/// Command [rad/s, rad, m^3, m] of a jet that is told `force` (Drive).
[[nodiscard]] double command_of(const Craft& craft, const Jet& jet, double force);
/// `dof`, `hull`, `windage` and `actuators` of the vehicle file.
[[nodiscard]] std::string other_keys(const Craft& craft);
[[nodiscard]] std::string to_map(const Craft& craft, bool voltage);

}  // namespace fathom::sealed
