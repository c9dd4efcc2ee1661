#include "common/model/sensors/heading.hpp"

#include <cmath>
#include <limits>

namespace fathom::model {
namespace {

constexpr double kLevel = 0.1;  // cosine of the pitch below which there is no heading to speak of

}  // namespace

Observation observe_heading(const KinematicPoint& point, double declination, double measured, double variance) {
  const Eigen::Vector3d euler = euler_from_rotation(point.R_WB);
  Observation result;
  result.innovation = wrap_angle(measured + declination - euler.z());
  const double level = std::cos(euler.y());
  result.variance = level > kLevel ? variance : std::numeric_limits<double>::infinity();
  // How turns in B change the heading, by how the angles turn B.
  const Eigen::Vector3d by_turn{0.0, std::sin(euler.x()) / level, std::cos(euler.x()) / level};
  result.set(at::kAngles, (by_turn.transpose() * point.turn_from_angles).transpose());
  return result;
}

}  // namespace fathom::model
