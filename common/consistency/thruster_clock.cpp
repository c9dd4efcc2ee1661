#include "common/consistency/thruster_clock.hpp"

namespace fathom::consistency {

void put_thrusters_on_pose_clock(ConsistencyResult& result) {
  for (Corrections& one : result.corrections) {
    one.pose_shift = 0.0;
    one.gyro_shift = -one.gyro.delay;
    one.dvl_shift = -one.dvl.delay;
  }
  for (ConsistencyFinding& finding : result.findings) {
    if (finding.signal != "thrusters" || finding.finding != "clock") continue;
    finding.evidence =
        "the clocks differ; on that of the gyro thrust would be as late as the gyro is: the thrusters are on that of "
        "the pose, and the gyro alone is late";
    finding.action = "thruster and pose stamps unshifted";
  }
}

}  // namespace fathom::consistency
