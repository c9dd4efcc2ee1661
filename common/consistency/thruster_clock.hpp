// On whose clock thrusters are where gyro and pose have clocks of their own: kinematics cannot tell, forces can.
#pragma once

#include "common/consistency/consistency.hpp"

namespace fathom::consistency {

/// Takes the pose's clock for the thrusters' in place of the gyro's, and says so in the findings. To be asked where
/// thrust was found as late as the gyro is: one late sensor is more likely than two delays that are the same.
void put_thrusters_on_pose_clock(ConsistencyResult& result);

}  // namespace fathom::consistency
