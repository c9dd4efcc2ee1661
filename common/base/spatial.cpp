#include "common/base/spatial.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace fathom {

Eigen::Matrix3d rotation_from_euler(const Eigen::Vector3d& euler) {
  return (Eigen::AngleAxisd(euler.z(), Eigen::Vector3d::UnitZ()) *
          Eigen::AngleAxisd(euler.y(), Eigen::Vector3d::UnitY()) *
          Eigen::AngleAxisd(euler.x(), Eigen::Vector3d::UnitX()))
      .toRotationMatrix();
}

Eigen::Vector3d euler_from_rotation(const Eigen::Matrix3d& R_WB) {
  return {std::atan2(R_WB(2, 1), R_WB(2, 2)), -std::asin(std::clamp(R_WB(2, 0), -1.0, 1.0)),
          std::atan2(R_WB(1, 0), R_WB(0, 0))};
}

Eigen::Quaterniond quaternion_from_rotation_vector(const Eigen::Vector3d& phi) {
  const double x = 0.25 * phi.squaredNorm();  // half the angle, squared
  double cosine, scale;
  if (x < 0.01) {  // what turns in a step; the next terms are under 1e-16
    cosine = 1.0 - x * (1.0 / 2.0 - x * (1.0 / 24.0 - x * (1.0 / 720.0 - x * (1.0 / 40320.0))));
    scale = 0.5 - x * (1.0 / 12.0 - x * (1.0 / 240.0 - x * (1.0 / 10080.0 - x * (1.0 / 725760.0))));
  } else {
    const double half = std::sqrt(x);
    cosine = std::cos(half);
    scale = 0.5 * std::sin(half) / half;
  }
  return Eigen::Quaterniond(cosine, scale * phi.x(), scale * phi.y(), scale * phi.z());
}

Eigen::Vector3d rotation_vector_from_quaternion(const Eigen::Quaterniond& q) {
  const double sign = q.w() < 0.0 ? -1.0 : 1.0;
  const double sine = q.vec().norm();
  const double angle = 2.0 * std::atan2(sine, sign * q.w());
  const double scale = sine < 1e-8 ? 2.0 : angle / sine;
  return sign * scale * q.vec();
}

Eigen::Matrix3d right_jacobian(const Eigen::Vector3d& phi) {
  const double x = phi.squaredNorm(), angle = std::sqrt(x);
  const bool small = x < 1e-4;  // rad^2: series of three terms are exact to 1e-16
  const double one = small ? 0.5 - x * (1.0 / 24.0 - x / 720.0) : (1.0 - std::cos(angle)) / x;
  const double two = small ? 1.0 / 6.0 - x * (1.0 / 120.0 - x / 5040.0) : (angle - std::sin(angle)) / (x * angle);
  const Eigen::Matrix3d by = skew(phi);
  return Eigen::Matrix3d::Identity() - one * by + two * by * by;
}

double wrap_angle(double angle) {
  const double folded = std::remainder(angle, 2.0 * std::numbers::pi);
  return folded <= -std::numbers::pi ? folded + 2.0 * std::numbers::pi : folded;
}

}  // namespace fathom
