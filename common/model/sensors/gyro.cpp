#include "common/model/sensors/gyro.hpp"

namespace fathom::model {

Observation observe(const KinematicPoint& point, const Gyro& sensor, double measured, double variance) {
  Observation result;
  result.innovation = measured - sensor.direction_B.dot(point.group(at::kRates));
  result.variance = variance;
  result.set(at::kRates, sensor.direction_B);
  if (sensor.bias >= 0) result.add_bias(point.x, sensor.bias);
  return result;
}

}  // namespace fathom::model
