#include "common/model/sensors/kinematic_point.hpp"

#include <cmath>

namespace fathom::model {

KinematicPoint::KinematicPoint(const KinematicVector& state, const std::optional<Eigen::Matrix3d>& reference)
    : x{state} {
  const Eigen::Vector3d angles = group(at::kAngles);
  if (reference) {
    R_WB = *reference * quaternion_from_rotation_vector(angles).toRotationMatrix();
    turn_from_angles = right_jacobian(angles);
  } else {
    const double sr = std::sin(angles.x()), cr = std::cos(angles.x());
    const double sp = std::sin(angles.y()), cp = std::cos(angles.y());
    const double sy = std::sin(angles.z()), cy = std::cos(angles.z());
    R_WB << cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr,  //
        sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr,      //
        -sp, cp * sr, cp * cr;
    turn_from_angles << 1.0, 0.0, -sp, 0.0, cr, sr * cp, 0.0, -sr, cr * cp;
  }
  down_B = R_WB.row(2).transpose();
}

}  // namespace fathom::model
