// Position and velocity log differ by one factor, and kinematics cannot tell which of the two is wrong: forces can, for
// couplings of turning and moving do not scale.
#pragma once

#include "common/consistency/consistency.hpp"

namespace fathom::consistency {

/// Lays the factor on the velocity log in place of the position, and says so in the findings.
void put_scale_on_velocity_log(ConsistencyResult& result);
/// Adds to the finding about the factor what decided which of the two is scaled, or that nothing did.
void say_of_scale(ConsistencyResult& result, const std::string& why);

}  // namespace fathom::consistency
