#include "common/model/sensors/range.hpp"

namespace fathom::model {
namespace {

constexpr double kNearest = 1e-3;  // m

}  // namespace

Observation observe_range(const KinematicPoint& point, const Eigen::Vector3d& p_BP, const Eigen::Vector3d& p_WT,
                          double measured, double variance) {
  const Eigen::Vector3d apart = point.group(at::kPosition) + point.R_WB * p_BP - p_WT;
  const double range = apart.norm();
  Observation result;
  result.innovation = measured - range;
  result.variance = variance;
  const Eigen::Vector3d away = range > kNearest ? Eigen::Vector3d(apart / range) : Eigen::Vector3d::Zero();
  point.set_along(away, p_BP, result);
  return result;
}

}  // namespace fathom::model
