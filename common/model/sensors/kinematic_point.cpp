#include "common/model/sensors/kinematic_point.hpp"

#include <cmath>

namespace fathom::model {

KinematicPoint::KinematicPoint(const KinematicVector& state, const Eigen::Matrix3d& reference) : x{state} {
  const double sr = sin_roll = std::sin(x[6]), cr = cos_roll = std::cos(x[6]);
  const double sp = sin_pitch = std::sin(x[7]), cp = cos_pitch = std::cos(x[7]);
  const double sy = std::sin(x[8]), cy = std::cos(x[8]);
  Eigen::Matrix3d turned;
  turned << cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr,  //
      sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr,        //
      -sp, cp * sr, cp * cr;
  R_WB = reference * turned;
  euler_from_rates << 1.0, sr * sp / cp, cr * sp / cp, 0.0, cr, -sr, 0.0, sr / cp, cr / cp;
  rates_from_euler << 1.0, 0.0, -sp, 0.0, cr, sr * cp, 0.0, -sr, cr * cp;
  down_B = R_WB.row(2).transpose();
}

}  // namespace fathom::model
