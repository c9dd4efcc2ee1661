#include "common/model/sensors/position.hpp"

namespace fathom::model {

std::array<Observation, 3> observe_position(const KinematicPoint& point, const Eigen::Vector3d& p_BP,
                                            const Eigen::Vector3d& measured, const Eigen::Vector3d& variance) {
  const Eigen::Vector3d innovation = measured - point.group(at::kPosition) - point.R_WB * p_BP;
  std::array<Observation, 3> result;
  for (int i = 0; i < 3; ++i) {
    Observation& one = result[static_cast<std::size_t>(i)];
    one.innovation = innovation[i];
    one.variance = variance[i];
    point.set_along(Eigen::Vector3d::Unit(i), p_BP, one);
  }
  return result;
}

}  // namespace fathom::model
