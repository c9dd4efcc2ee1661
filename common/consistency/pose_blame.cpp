// When gyro and DVL both contradict the pose in one way, the pose is to blame: its body axes, its unit, its heading.
#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "common/base/spatial.hpp"
#include "common/base/statistics.hpp"
#include "common/base/units.hpp"
#include "common/consistency/consistency_check.hpp"
#include "common/consistency/increments/increment_estimate.hpp"
#include "common/estimation/wording.hpp"

namespace fathom::consistency {
namespace {

constexpr double kSameHeading = 0.5 * kDegree;  // less between runs is one heading
constexpr double kSoundSpeed = 0.04;  // of a velocity log's scale: 0 deg fresh water for 30 deg sea water is 10 %, but
                                      // users set it; what is left is below this
constexpr double kLeastScatter = 2e-3;   // of scales that agree: smaller steps than sensors are calibrated to
constexpr double kAlike = 0.25;          // of the scale's error by which axes may differ and still be one factor
constexpr double kDistanceFloor = 0.02;  // of a ratio of distances; less changes no fitted model much
constexpr double kStretch = 2.0;         // s of travel that are compared
constexpr int kBlocks = 10;

constexpr double kSameTurn = 0.4;  // of the smaller turn: two sensors that agree so well are not both wrong by chance

Eigen::Vector3d rotation_vector(const Eigen::Matrix3d& rotation) {
  return rotation_vector_from_quaternion(Eigen::Quaterniond(rotation));
}

/// Position's way over the velocity log's, over stretches; its sigma by leaving out one block of the run at a time.
/// `lever` [m]: where the log measures; its point moves by the change of R r more than the origin.
Estimate distance_ratio(const PoseSeries& pose, const Series& velocity, const Eigen::Vector3d& lever) {
  Estimate result;
  const Spline spline(velocity);
  struct Sums {
    double xy{}, xx{};
  };
  std::array<Sums, kBlocks> blocks{};
  std::vector<std::array<double, 2>> stretches;  // xy, xx
  Eigen::Vector3d way = Eigen::Vector3d::Zero(), before = Eigen::Vector3d::Zero(), v;
  std::size_t first = 0;
  bool whole = false;
  for (std::size_t i = 0; i < pose.size(); ++i) {
    const bool there = pose.valid[i] != 0 && spline.at(pose.t[i], v);
    if (!there || !whole) {
      first = i;
      whole = there;
      way.setZero();
      before = there ? Eigen::Vector3d(pose.q_WB[i] * v) : Eigen::Vector3d(Eigen::Vector3d::Zero());
      continue;
    }
    const Eigen::Vector3d now = pose.q_WB[i] * v;
    way += 0.5 * (pose.t[i] - pose.t[i - 1]) * (before + now);
    before = now;
    if (pose.t[i] - pose.t[first] < kStretch) continue;
    const Eigen::Vector3d moved = pose.p_WB[i] - pose.p_WB[first];
    way -= pose.q_WB[i] * lever - pose.q_WB[first] * lever;
    stretches.push_back({way.dot(moved), way.squaredNorm()});
    whole = false;
  }
  if (stretches.size() < 2 * static_cast<std::size_t>(kBlocks)) return result;
  Sums all;
  for (std::size_t k = 0; k < stretches.size(); ++k) {
    Sums& block = blocks[k * static_cast<std::size_t>(kBlocks) / stretches.size()];
    block.xy += stretches[k][0], block.xx += stretches[k][1];
    all.xy += stretches[k][0], all.xx += stretches[k][1];
  }
  if (!(all.xx > 0.0)) return result;
  std::vector<double> replicates;
  for (const Sums& block : blocks) replicates.push_back((all.xy - block.xy) / std::max(all.xx - block.xx, 1e-12));
  // The velocity's own noise pulls the ratio down: what it adds to the way's square is taken for the doubt.
  const double step = typical_step(velocity.t);
  double noise = 0.0;
  for (int k = 0; k < 3; ++k) {
    std::vector<double> part;
    for (const Eigen::Vector3d& x : velocity.x) part.push_back(x[k]);
    noise += std::pow(white_noise_sigma(velocity.t, part), 2) * step * kStretch;
  }
  const double pulled = noise * static_cast<double>(stretches.size()) / all.xx;
  result.value = all.xy / all.xx;
  result.sigma = std::hypot(jackknife_sigma(replicates), pulled);
  result.freedom = kBlocks - 1;
  result.informative = pulled < 0.1;
  return result;
}

}  // namespace

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

/// A heading that is turned against the track, by an angle that the recordings share, or each by its own where a log
/// zeroes its heading at the start or a compass drifts.
bool Check::find_heading(const PairResult& dvl) {
  std::vector<Estimate> estimates(runs_.size());
  for (std::size_t r = 0; r < runs_.size(); ++r) {
    const IncrementFit& fit = dvl.fits[r];
    if (!fit.ok || fit.theta_replicates.empty() || fit.theta.size() < 16) continue;
    estimates[r] = estimate(
        fit, [](const Eigen::VectorXd& theta) { return theta[15]; }, false);
    estimates[r].informative = estimates[r].sigma < 2.0 * kDegree;
  }
  const SharedValue shared = share(estimates, 0.0, 0.5 * kDegree);
  bool moved = false, any = false, alike = true;
  for (std::size_t r = 0; r < runs_.size(); ++r) {
    double& heading = result_.corrections[r].heading;
    moved = moved || shared.applied[r] != 0.0;
    heading += shared.applied[r];
    any = any || heading != 0.0;
    alike = alike && std::abs(std::remainder(heading - result_.corrections[0].heading, 360.0 * kDegree)) < kSameHeading;
  }
  if (!any) return false;
  std::erase_if(result_.findings, [](const ConsistencyFinding& one) { return one.finding == "heading_offset"; });
  const auto say = [&](const std::string& run, double heading, double sigma, const std::string& others) {
    const double offset = -std::remainder(heading, 360.0 * kDegree);
    result_.findings.push_back(
        {.run = run,
         .signal = reference_ + ".attitude",
         .reference = "pose_capture.position and dvl",
         .finding = "heading_offset",
         .size = offset,
         .unit = "rad",
         .evidence = text("heading and track over ground differ by %.2f +- %.2f deg at all headings", offset / kDegree,
                          sigma / kDegree) +
                     others,
         .action = "corrected: attitude turned about the vertical" +
                   std::string(others.empty() ? "" : ", each run by its own angle")});
  };
  if (alike) {
    say("all", result_.corrections[0].heading, shared.pooled.sigma, "");
    return moved;
  }
  for (std::size_t r = 0; r < runs_.size(); ++r) {
    std::string others;
    for (std::size_t o = 0; o < runs_.size(); ++o) {
      if (o == r) continue;
      others += (others.empty() ? "; the runs disagree: " : ", ") + names_[o] +
                text(" %.1f deg", -std::remainder(result_.corrections[o].heading, 360.0 * kDegree) / kDegree);
    }
    say(names_[r], result_.corrections[r].heading, estimates[r].informative ? estimates[r].sigma : 0.0,
        others + " (a heading zeroed at each start, or a compass that drifts)");
  }
  return moved;
}

/// Position and velocity log differ by one factor on all axes that are seen. Neither sees the other's fault: both are
/// named. Where the factor is more than a wrong speed of sound can make, the position's projection or calibration is
/// the likelier, and it is scaled; less is left to the velocity log, whose scale is then found axis by axis.
bool Check::blame_position_scale(const PairResult& dvl) {
  if (!dvl.checked) return false;
  std::vector<double> scales;
  for (const SensorFault& fault : dvl.faults) {
    for (int k = 0; k < 3; ++k) {
      if (fault.scale[k] != 1.0) scales.push_back(fault.scale[k]);
    }
  }
  if (scales.size() < 2 * runs_.size()) return false;
  const auto [least, most] = std::ranges::minmax(scales);
  const double scale = median(scales);
  if (std::abs(scale - 1.0) < kSoundSpeed || most - least > kAlike * std::abs(scale - 1.0)) return false;
  // A depth sensor that agrees with the position's vertical as it is speaks for the position.
  const auto depth_disagrees = [&] {
    bool any = false;
    for (std::size_t r = 0; r < runs_.size(); ++r) {
      for (const ConsistencyFinding& one : compare_depth(runs_[r], pose(r))) any = any || one.finding == "scale";
    }
    return any;
  };
  const bool before = depth_disagrees();
  for (Corrections& corrections : result_.corrections) corrections.position_scale /= scale;
  if (!before && depth_disagrees()) {
    for (Corrections& corrections : result_.corrections) corrections.position_scale *= scale;
    return false;
  }
  report(
      "pose_capture.position", "scale", scale, "",
      text("the position moves %.4g times as far as the velocity log says, on all axes alike; a wrong speed of sound "
           "makes no more than %.0f %%: the position's projection, calibration or unit is the likelier, the velocity "
           "log's scale is possible",
           scale, 100.0 * kSoundSpeed) +
          "; a straight leg between two points of known distance, or a second velocity, settles it",
      "corrected: the position is divided by the size (the map's 'unit' or a projection of the position)", "dvl");
  result_.findings.back().std =
      std::max(0.5 * (most - least), kLeastScatter) / std::sqrt(static_cast<double>(scales.size()));
  result_.findings.back().or_else = "dvl";
  result_.either_scale = scale;
  return true;
}

/// How far the position moves for each metre of the velocity log, whatever else was found: at one speed a scale and an
/// offset are one and the same, and no axis by itself is seen.
void Check::compare_distances(const PairResult& dvl) {
  std::vector<Estimate> ratios(runs_.size());
  for (std::size_t r = 0; r < runs_.size(); ++r) {
    if (!poses_[r].has_position || !poses_[r].has_attitude || dvl_[r].empty()) continue;
    const SensorFault fault = dvl.checked ? dvl.faults[r] : SensorFault{};
    if (!fault.coupling.isZero()) continue;  // what goes with the rates is no scale
    ratios[r] = distance_ratio(pose(r), on_reference_clock(fault, dvl_[r]), fault.lever);
  }
  const SharedValue ratio = share(ratios, 1.0, kDistanceFloor);
  result_.distance = ratio.pooled;
  result_.distance_limit = ratio.limit;
  if (!ratio.found && ratio.different.empty()) return;
  const auto say = [&](const std::string& run, double value, double sigma) {
    result_.findings.push_back(
        {.run = run,
         .signal = "pose_capture.position",
         .reference = "dvl",
         .finding = "distance",
         .size = value,
         .unit = "",
         .evidence = text("the position moves %.4g +- %.2g times as far as the velocity log says", value, sigma) +
                     "; a scale and an offset cannot be told apart at one speed, nor which of the two is wrong" +
                     (std::abs(value - 1.0) > kSoundSpeed
                          ? std::string("; a wrong speed of sound makes no such error, so the position's projection, "
                                        "calibration or unit is the likelier")
                          : std::string()) +
                     "; settled by runs at several speeds, and by a straight leg between two points of known distance",
         .action = "reported only: neither is corrected; correct the one that is wrong in the map"});
  };
  if (ratio.found) say("all", ratio.pooled.value, ratio.pooled.sigma);
  for (const std::size_t r : ratio.different) say(names_[r], ratios[r].value, ratios[r].sigma);
}

}  // namespace fathom::consistency
