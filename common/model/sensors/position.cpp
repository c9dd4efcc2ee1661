#include "common/model/sensors/position.hpp"

namespace fathom::model {
namespace {

constexpr double kNearest = 1e-3;  // m

void set_along(const KinematicPoint& point, const Eigen::Vector3d& along_W, const Eigen::Vector3d& p_BP,
               Observation& result) {
  result.set(at::kPosition, along_W);
  if (!p_BP.isZero(0.0)) result.set(at::kEuler, (along_W.transpose() * point.turned_out(p_BP)).transpose());
}

}  // namespace

Observation observe_depth(const KinematicPoint& point, const Eigen::Vector3d& p_BP, double measured, double variance) {
  Observation result;
  result.innovation = measured - (point.x[at::kPosition + 2] + point.down_B.dot(p_BP));
  result.variance = variance;
  set_along(point, Eigen::Vector3d::UnitZ(), p_BP, result);
  return result;
}

Observation observe_range(const KinematicPoint& point, const Eigen::Vector3d& p_BP, const Eigen::Vector3d& p_WT,
                          double measured, double variance) {
  const Eigen::Vector3d apart = point.group(at::kPosition) + point.R_WB * p_BP - p_WT;
  const double range = apart.norm();
  Observation result;
  result.innovation = measured - range;
  result.variance = variance;
  set_along(point, range > kNearest ? Eigen::Vector3d(apart / range) : Eigen::Vector3d(Eigen::Vector3d::Zero()), p_BP,
            result);
  return result;
}

std::array<Observation, 3> observe_position(const KinematicPoint& point, const Eigen::Vector3d& p_BP,
                                            const Eigen::Vector3d& measured, const Eigen::Vector3d& variance) {
  const Eigen::Vector3d innovation = measured - point.group(at::kPosition) - point.R_WB * p_BP;
  std::array<Observation, 3> result;
  for (int i = 0; i < 3; ++i) {
    Observation& one = result[static_cast<std::size_t>(i)];
    one.innovation = innovation[i];
    one.variance = variance[i];
    set_along(point, Eigen::Vector3d::Unit(i), p_BP, one);
  }
  return result;
}

}  // namespace fathom::model
