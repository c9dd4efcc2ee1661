// When gyro and DVL both contradict the pose in one way, the pose is to blame: its body axes, its unit, its heading.
#include <cmath>

#include "common/base/statistics.hpp"
#include "common/base/units.hpp"
#include "common/estimation/consistency_check.hpp"
#include "common/estimation/wording.hpp"

namespace fathom::estimation {

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
  std::vector<double> values, sigmas;
  for (const IncrementFit& fit : dvl.fits) {
    if (!fit.ok || fit.theta_replicates.empty() || fit.theta.size() < 16) continue;
    std::vector<double> replicates;
    for (const Eigen::VectorXd& theta : fit.theta_replicates) replicates.push_back(theta[15]);
    const double sigma = jackknife_sigma(replicates);
    if (sigma > 2.0 * kDegree) continue;
    values.push_back(fit.theta[15]);
    sigmas.push_back(sigma);
  }
  const Pooled pooled = pool(values, sigmas);
  const double before = result_.corrections.empty() ? 0.0 : result_.corrections[0].heading;
  const bool significant =
      pooled.count > 0 && std::abs(pooled.value) > 6.0 * pooled.sigma && std::abs(pooled.value) > 0.5 * kDegree;
  if (significant) {
    for (Corrections& corrections : result_.corrections) corrections.heading += pooled.value;
  }
  const double heading = before + (significant ? pooled.value : 0.0);
  if (heading == 0.0) return false;
  std::erase_if(result_.findings, [](const ConsistencyFinding& one) { return one.finding == "heading_offset"; });
  const double offset = -std::remainder(heading, 360.0 * kDegree);
  report(reference_ + ".attitude", "heading_offset", offset, "rad",
         text("heading and track over ground differ by %.2f +- %.2f deg at all headings", offset / kDegree,
              pooled.sigma / kDegree),
         "corrected: attitude turned about the vertical", "pose_capture.position and dvl");
  return significant;
}

}  // namespace fathom::estimation
