// When gyro and DVL both contradict the pose in one way, the pose is to blame: its body axes, its unit, its heading.
#include <algorithm>
#include <cmath>
#include <vector>

#include "common/base/spatial.hpp"
#include "common/base/units.hpp"
#include "common/estimation/consistency_check.hpp"
#include "common/estimation/increment_estimate.hpp"
#include "common/estimation/wording.hpp"

namespace fathom::estimation {
namespace {

constexpr double kSameTurn = 0.4;  // of the smaller turn: two sensors that agree so well are not both wrong by chance

Eigen::Vector3d rotation_vector(const Eigen::Matrix3d& rotation) {
  return rotation_vector_from_quaternion(Eigen::Quaterniond(rotation));
}

}  // namespace

/// Gyro and DVL turned in the same way against the pose: then it is the pose's body axes that are turned.
bool Check::blame_pose_axes(const PairResult& gyro, const PairResult& dvl) {
  if (!gyro.checked || !dvl.checked || runs_.empty()) return false;
  const Eigen::Matrix3d base = gyro.faults[0].base;
  if (base.isIdentity() || base.determinant() < 0.0 || base != dvl.faults[0].base) return false;
  for (Corrections& corrections : result_.corrections) corrections.attitude_axes = base;
  report("pose_capture.attitude", "axes", 1.0, "",
         "gyro and DVL agree with each other and are both turned against the pose: its body axes are",
         "corrected: body axes of the pose turned", "gyro and dvl");
  return true;
}

/// Gyro and DVL turned by the same small angles against the pose: then it is the pose that sits tilted on the vehicle.
bool Check::blame_pose_tilt(const PairResult& gyro, const PairResult& dvl) {
  if (!gyro.checked || !dvl.checked || runs_.empty()) return false;
  std::vector<Eigen::Vector3d> tilt;
  for (std::size_t r = 0; r < runs_.size(); ++r) {
    const Eigen::Vector3d one = rotation_vector(gyro.faults[r].rotation),
                          other = rotation_vector(dvl.faults[r].rotation);
    tilt.emplace_back(0.5 * (one + other));
    if ((one - other).norm() > kSameTurn * std::min(one.norm(), other.norm()) || !(tilt.back().norm() > 0.0))
      return false;
  }
  for (std::size_t r = 0; r < runs_.size(); ++r) {
    Eigen::Matrix3d& axes = result_.corrections[r].attitude_axes;
    axes = axes * quaternion_from_rotation_vector(tilt[r]).toRotationMatrix();
  }
  const Eigen::Vector3d& told = tilt.front();
  report("pose_capture.attitude", "misalignment", told.norm(), "rad",
         text("gyro and DVL agree with each other and are both turned against the pose, by %.2f, %.2f, %.2f deg about "
              "body x, y, z",
              told.x() / kDegree, told.y() / kDegree, told.z() / kDegree),
         "corrected: body axes of the pose turned", "gyro and dvl");
  return true;
}

/// A reference 100, 1000 or 3.28 times too large is in smaller units; a DVL in kilometres does not exist.
bool Check::blame_position_unit(const PairResult& dvl) {
  if (!dvl.checked) return false;
  std::vector<double> scales;
  for (const SensorFault& fault : dvl.faults) {
    for (int k = 0; k < 3; ++k) {
      if (fault.scale[k] != 1.0) scales.push_back(fault.scale[k]);
    }
  }
  const double scale = median(scales);
  for (const auto& [factor, unit] : {std::pair{100.0, "centimetres"}, {1000.0, "millimetres"}, {3.28084, "feet"}}) {
    if (std::abs(scale / factor - 1.0) > 0.1 || scales.size() < runs_.size()) continue;
    for (Corrections& corrections : result_.corrections) corrections.position_scale /= factor;
    report("pose_capture.position", "unit", factor, "",
           std::string("the position is in ") + unit + text(": it moves %.4g times as far as the DVL says", scale),
           "corrected: divided by the size", "dvl");
    return true;
  }
  return false;
}

bool Check::find_heading(const PairResult& dvl) {
  std::vector<Estimate> estimates;
  for (const IncrementFit& fit : dvl.fits) {
    if (!fit.ok || fit.theta_replicates.empty() || fit.theta.size() < 16) continue;
    estimates.push_back(estimate(
        fit, [](const Eigen::VectorXd& theta) { return theta[15]; }, false));
    estimates.back().informative = estimates.back().sigma < 2.0 * kDegree;
  }
  const SharedValue shared = share(estimates, 0.0, 0.5 * kDegree);
  const double before = result_.corrections.empty() ? 0.0 : result_.corrections[0].heading;
  if (shared.found) {
    for (Corrections& corrections : result_.corrections) corrections.heading += shared.pooled.value;
  }
  const double heading = before + (shared.found ? shared.pooled.value : 0.0);
  if (heading == 0.0) return false;
  std::erase_if(result_.findings, [](const ConsistencyFinding& one) { return one.finding == "heading_offset"; });
  const double offset = -std::remainder(heading, 360.0 * kDegree);
  report(reference_ + ".attitude", "heading_offset", offset, "rad",
         text("heading and track over ground differ by %.2f +- %.2f deg at all headings", offset / kDegree,
              shared.pooled.sigma / kDegree),
         "corrected: attitude turned about the vertical", "pose_capture.position and dvl");
  return shared.found;
}

}  // namespace fathom::estimation
