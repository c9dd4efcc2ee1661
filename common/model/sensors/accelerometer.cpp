#include "common/model/sensors/accelerometer.hpp"

namespace fathom::model {

Observation observe(const KinematicPoint& point, const Accelerometer& sensor, double measured, double variance) {
  const Eigen::Vector3d& r = sensor.p_BI;
  const Eigen::Vector3d& d = sensor.direction_B;
  const Eigen::Vector3d w = point.group(at::kRates);
  const Eigen::Vector3d felt = point.group(at::kAcceleration) + w.cross(w.cross(r)) +
                               point.group(at::kRateSlopes).cross(r) - sensor.gravity * point.down_B;
  Observation result;
  result.innovation = measured - d.dot(felt);
  result.variance = variance;
  result.set(at::kAcceleration, d);
  result.set(at::kAngles, -sensor.gravity * (d.transpose() * point.turned_in(point.down_B)).transpose());
  if (!r.isZero(0.0)) {
    // d/dw of d . (w (w . r) - r (w . w)), and of d . (w_dot x r).
    result.set(at::kRates, d * w.dot(r) + r * w.dot(d) - 2.0 * w * r.dot(d));
    result.set(at::kRateSlopes, r.cross(d));
  }
  if (sensor.bias >= 0) result.add_bias(point.x, sensor.bias);
  return result;
}

}  // namespace fathom::model
