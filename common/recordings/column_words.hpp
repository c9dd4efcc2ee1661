// What a stranger's column is called, apart from how it is written.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace fathom::recordings {

/// The words of a name (surge_vel, "Surge Velocity", surgeVelocity), sorted: lower case, one word for each meaning
/// ("vel" of velocity and speed, "stbd" of starboard and right), without those that say only what measured it.
[[nodiscard]] std::vector<std::string> words_of(std::string_view name);

/// The same of an actuator's name or of a column that may command it, without those that say that it is one ("rpm",
/// "motor", "cmd"): "rpm_port", "port thruster cmd" and "Motor Port" are all {port}. Empty: nothing else is said.
[[nodiscard]] std::vector<std::string> words_of_actuator(std::string_view name);

}  // namespace fathom::recordings
