#include "common/model/sensors/velocity_log.hpp"

namespace fathom::model {

std::array<Observation, 3> observe_velocity(const KinematicPoint& point, const Eigen::Vector3d& p_BD,
                                            const Eigen::Vector3d& measured, double variance, bool biased) {
  const Eigen::Vector3d v_B = point.R_WB.transpose() * point.group(at::kVelocity);
  const Eigen::Vector3d innovation = measured - v_B - point.group(at::kRates).cross(p_BD);
  const Eigen::Matrix3d by_angles = point.turned_in(v_B), by_rates = -skew(p_BD);
  std::array<Observation, 3> result;
  for (int i = 0; i < 3; ++i) {
    Observation& one = result[static_cast<std::size_t>(i)];
    one.innovation = innovation[i];
    one.variance = variance;
    one.set(at::kVelocity, point.R_WB.col(i));
    one.set(at::kAngles, by_angles.row(i).transpose());
    if (!p_BD.isZero(0.0)) one.set(at::kRates, by_rates.row(i).transpose());
    if (biased) one.add_bias(point.x, at::kLogBias - at::kBias + i);
  }
  return result;
}

}  // namespace fathom::model
