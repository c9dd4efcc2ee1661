#include "common/model/sensors/attitude.hpp"

namespace fathom::model {

namespace {

std::array<Observation, 3> rows(const Eigen::Vector3d& innovation, const Eigen::Vector3d& variance,
                                const Eigen::Matrix3d& by_angles) {
  std::array<Observation, 3> result;
  for (int i = 0; i < 3; ++i) {
    Observation& one = result[static_cast<std::size_t>(i)];
    one.innovation = innovation[i];
    one.variance = variance[i];
    one.set(at::kAngles, by_angles.row(i).transpose());
  }
  return result;
}

Eigen::Vector3d turn_to(const KinematicPoint& point, const Eigen::Quaterniond& measured) {
  return rotation_vector_from_quaternion(Eigen::Quaterniond{point.R_WB}.conjugate() * measured);
}

}  // namespace

std::array<Observation, 3> observe_attitude(const KinematicPoint& point, const Eigen::Quaterniond& measured,
                                            double variance) {
  return rows(turn_to(point, measured), Eigen::Vector3d::Constant(variance), point.turn_from_angles);
}

std::array<Observation, 3> observe_attitude(const KinematicPoint& point, const Eigen::Quaterniond& measured,
                                            const Eigen::Vector3d& variance) {
  return rows(point.R_WB * turn_to(point, measured), variance, point.R_WB * point.turn_from_angles);
}

}  // namespace fathom::model
