#include "common/model/sensors/gyro.hpp"

namespace fathom::model {

Observation observe(const KinematicPoint& point, const Gyro& sensor, double measured, double variance) {
  Observation result;
  result.innovation = measured - sensor.direction_B.dot(point.group(at::kRates));
  result.variance = variance;
  result.set(at::kRates, sensor.direction_B);
  if (sensor.bias >= 0) {
    result.innovation -= point.x[at::kBias + sensor.bias];
    result.row[at::kBias + sensor.bias] = 1.0;
    result.groups |= 1U << static_cast<unsigned>((at::kBias + sensor.bias) / 3);
  }
  return result;
}

}  // namespace fathom::model
