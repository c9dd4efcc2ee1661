#include "common/model/sensors/attitude.hpp"

namespace fathom::model {

std::array<Observation, 3> observe_attitude(const KinematicPoint& point, const Eigen::Quaterniond& measured,
                                            double variance) {
  const Eigen::Quaterniond estimate{point.R_WB};
  const Eigen::Vector3d innovation = rotation_vector_from_quaternion(estimate.conjugate() * measured);
  std::array<Observation, 3> result;
  for (int i = 0; i < 3; ++i) {
    Observation& one = result[static_cast<std::size_t>(i)];
    one.innovation = innovation[i];
    one.variance = variance;
    one.set(at::kEuler, point.rates_from_euler.row(i).transpose());
  }
  return result;
}

}  // namespace fathom::model
