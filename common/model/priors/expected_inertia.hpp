// What a vehicle is expected to weigh with the water that it moves: settings that were found on one vehicle hold for
// another in proportion to it.
#pragma once

#include "common/base/spatial.hpp"
#include "common/model/vehicle.hpp"

namespace fathom::model {

/// Mass with added mass [kg] and inertia likewise [kg m^2] of each axis X Y Z K M N: the vehicle file's prior, else a
/// wide one. Zero on an axis of which the file says nothing.
[[nodiscard]] Vector6d expected_inertia(const Vehicle& vehicle);

/// The same over that of the LBV150 of Karras et al. (Table 1.1). Forces, drag and their doubts grow with it, so that
/// at the same motion as much is known of either in proportion. 1 on the axes K M N, whose noise is the gyro's, and
/// where nothing is expected.
[[nodiscard]] Vector6d inertia_beside_lbv150(const Vehicle& vehicle);

}  // namespace fathom::model
