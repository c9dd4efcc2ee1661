#include "common/model/sensors/pressure.hpp"

namespace fathom::model {

Observation observe_depth(const KinematicPoint& point, const Eigen::Vector3d& p_BP, double measured, double variance) {
  Observation result;
  result.innovation = measured - (point.x[at::kPosition + 2] + point.down_B.dot(p_BP));
  result.variance = variance;
  point.set_along(Eigen::Vector3d::UnitZ(), p_BP, result);
  return result;
}

}  // namespace fathom::model
