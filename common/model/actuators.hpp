// Actuators whose force is not what is commanded: a propeller driven by its shaft's speed, which loses thrust as the
// vehicle advances; a rudder or fin, whose force grows with the square of the speed of the water past it, in a
// propeller's slipstream too; an azimuth thruster, which counts as two thrusters across each other; a buoyancy engine
// or ballast tank, and a mass that slides or turns in the hull, whose pull keeps to the world's down. All are given to
// a model as forces [N]: a propeller's in still water, a fin's at its reference speed, a weight as it is gained and,
// where it is moved, its moment when level [N m], so that gains, delays, lags and failures mean the same for each of
// them.
#pragma once

#include <span>
#include <vector>

#include "common/base/config.hpp"
#include "common/model/motion.hpp"
#include "common/model/vehicle.hpp"

namespace fathom::model {

/// Reads the vehicle file's `actuators` into thrusters and allocation; InputError with file and line.
void read_actuators(const Config& config, Vehicle& vehicle);

/// Whether commands alone, without logged forces, say what its actuators give.
[[nodiscard]] bool takes_commands(const Vehicle& vehicle);

/// Forces of all actuators [N], from their commands: pulses [us] where the vehicle has a curve and forces [N] where
/// not, shaft speeds [rad/s], angles [rad], volumes [m^3], masses [kg], ways [m]. `battery` [V] changes what pulses
/// give.
[[nodiscard]] std::vector<double> forces_of_commands(const Vehicle& vehicle, std::span<const double> commands,
                                                     double battery);

/// Force of actuator `i` [N] on its axis in this motion, given those in motion.force. Of weights: as given.
[[nodiscard]] double acting_force(const Vehicle& vehicle, const Motion& motion, Eigen::Index i);

/// Wrench of actuator `i` [N, N m] at Bo in this motion, given the forces in motion.force.
[[nodiscard]] Vector6d acting_wrench(const Vehicle& vehicle, const Motion& motion, Eigen::Index i);

/// Sum of it over all actuators; where neither flow nor attitude matters the allocation times the forces.
[[nodiscard]] Vector6d acting_wrench(const Vehicle& vehicle, const Motion& motion);

}  // namespace fathom::model
