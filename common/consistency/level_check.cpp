// Is the world's vertical the true one? A vehicle with its weight below its buoyancy hangs at the same angles to the
// vertical whatever its heading. In a world that is tilted against gravity those angles turn with the heading:
//   R_WB^T e_z = trim - R_WB^T n,   n: horizontal, the tilt of the world's down against the true one.
// Every stretch of a recording has a trim of its own, so that a load that shifts is no tilt.
#include <algorithm>
#include <array>
#include <cmath>

#include "common/base/factors.hpp"
#include "common/base/spatial.hpp"
#include "common/base/statistics.hpp"
#include "common/base/units.hpp"
#include "common/consistency/consistency.hpp"
#include "common/consistency/pairs/shared_value.hpp"
#include "common/estimation/wording.hpp"

namespace fathom::consistency {
namespace {

constexpr double kInterval = 1.0;            // s over which rest is judged
constexpr double kStillSpeed = 0.1;          // m/s: its drag heels no vehicle noticeably
constexpr double kStillTilting = 0.05;       // rad/s: it neither swings nor is driven over
constexpr double kStillTurning = 0.1;        // rad/s
constexpr double kStretch = 60.0;            // s with one trim
constexpr double kLeastRest = 30.0;          // s in all
constexpr double kSensible = 1.0 * kDegree;  // of a standard deviation: beyond, the recording says nothing
constexpr double kFloor = 0.5 * kDegree;     // less changes no fitted model
constexpr std::size_t kFewestStretches = 6;
constexpr double kLeastTurning = 0.02;  // variance of the heading's direction inside the stretches

/// Normal equations of one stretch for n, its trim taken out.
struct Stretch {
  Eigen::Matrix2d h{Eigen::Matrix2d::Zero()};
  Eigen::Vector2d g{Eigen::Vector2d::Zero()};
  double count{};
};

/// Samples at rest as three columns of world axes seen in the body, x and y only.
struct Seen {
  double t;
  Eigen::Matrix<double, 2, 3> axes;
};

std::vector<Seen> at_rest(const PoseSeries& pose, double step) {
  std::vector<Seen> seen;
  const auto half = static_cast<std::size_t>(std::lround(0.5 * kInterval / step));
  for (std::size_t i = half; half > 0 && i + half < pose.size(); ++i) {
    const std::size_t a = i - half, b = i + half;
    const double elapsed = pose.t[b] - pose.t[a];
    if (!pose.valid[a] || !pose.valid[i] || !pose.valid[b] || elapsed > 1.2 * kInterval) continue;
    const Eigen::Matrix3d from = pose.q_WB[a].toRotationMatrix(), to = pose.q_WB[b].toRotationMatrix();
    const double speed = pose.has_position ? (pose.p_WB[b] - pose.p_WB[a]).norm() / elapsed : 0.0;
    const double tilting = (to.row(2) - from.row(2)).norm() / elapsed;
    const double turning = pose.q_WB[a].angularDistance(pose.q_WB[b]) / elapsed;
    if (speed > kStillSpeed || tilting > kStillTilting || turning > kStillTurning) continue;
    seen.push_back({pose.t[i], pose.q_WB[i].toRotationMatrix().transpose().topRows<2>()});
  }
  return seen;
}

Stretch stretch_of(std::span<const Seen> seen) {
  Stretch stretch;
  Eigen::Matrix<double, 2, 3> mean = Eigen::Matrix<double, 2, 3>::Zero();
  for (const Seen& one : seen) mean += one.axes / static_cast<double>(seen.size());
  for (const Seen& one : seen) {
    const Eigen::Matrix<double, 2, 3> off = one.axes - mean;
    stretch.h += off.leftCols<2>().transpose() * off.leftCols<2>();
    stretch.g -= off.leftCols<2>().transpose() * off.col(2);
  }
  stretch.count = static_cast<double>(seen.size());
  return stretch;
}

std::array<Estimate, 2> tilt_of(const PoseSeries& pose) {
  const double step = typical_step(pose.t);
  if (!pose.has_attitude || step <= 0.0) return {};
  const std::vector<Seen> seen = at_rest(pose, step);
  if (static_cast<double>(seen.size()) * step < kLeastRest) return {};
  std::vector<Stretch> stretches;
  const auto number = [&](const Seen& one) { return std::floor((one.t - pose.t.front()) / kStretch); };
  for (std::size_t first = 0, end = 0; first < seen.size(); first = end) {
    while (end < seen.size() && number(seen[end]) == number(seen[first])) ++end;
    if (end - first > 20) stretches.push_back(stretch_of(std::span(seen).subspan(first, end - first)));
  }
  Stretch all;
  for (const Stretch& one : stretches) all = {all.h + one.h, all.g + one.g, all.count + one.count};
  if (stretches.size() < kFewestStretches || all.h.trace() < 2.0 * kLeastTurning * all.count) return {};
  const Eigen::Vector2d n = solve_symmetric(all.h, all.g);
  std::array<std::vector<double>, 2> replicates;
  for (const Stretch& one : stretches) {
    const Eigen::Vector2d without = solve_symmetric(all.h - one.h, all.g - one.g);
    for (std::size_t k = 0; k < 2; ++k) replicates[k].push_back(without[static_cast<Eigen::Index>(k)]);
  }
  std::array<Estimate, 2> result;
  for (std::size_t k = 0; k < 2; ++k) {
    result[k] = {.value = n[static_cast<Eigen::Index>(k)],
                 .sigma = jackknife_sigma(replicates[k]),
                 .freedom = static_cast<double>(stretches.size() - 1)};
  }
  const bool sure = std::max(result[0].sigma, result[1].sigma) < kSensible;
  for (Estimate& one : result) one.informative = sure;
  return result;
}

}  // namespace

std::vector<ConsistencyFinding> compare_with_vertical(const std::string& signal, std::span<const std::string> names,
                                                      std::span<const PoseSeries> poses) {
  std::array<std::vector<Estimate>, 2> estimates;
  for (const PoseSeries& pose : poses) {
    const std::array<Estimate, 2> tilt = tilt_of(pose);
    for (std::size_t k = 0; k < 2; ++k) estimates[k].push_back(tilt[k]);
  }
  const SharedValue x = share(estimates[0], 0.0, kFloor), y = share(estimates[1], 0.0, kFloor);
  std::vector<ConsistencyFinding> findings;
  const auto report = [&](const std::string& run, double to_x, double to_y, const std::string& from) {
    findings.push_back(
        {.run = run,
         .signal = signal,
         .reference = "vertical",
         .finding = "tilt",
         .size = std::hypot(to_x, to_y),
         .unit = "rad",
         .evidence =
             text("at rest roll and pitch turn with the heading as if down leant %.2f deg towards the world's x and "
                  "%.2f deg towards its y",
                  to_x / kDegree, to_y / kDegree) +
             from + "; a steady pull on the vehicle (a tether) would look the same, kinematics cannot tell",
         .action = "reported only: trim and restoring moments absorb part of it"});
  };
  if (x.found || y.found) {
    report("all", x.pooled.value, y.pooled.value,
           text(" (+- %.2f and %.2f, 1 sigma)", x.pooled.sigma / kDegree, y.pooled.sigma / kDegree) + ", from " +
               std::to_string(x.pooled.count) + " recordings");
  }
  for (std::size_t r = 0; r < poses.size(); ++r) {
    const auto differs = [&](const SharedValue& one) {
      return std::find(one.different.begin(), one.different.end(), r) != one.different.end();
    };
    if (differs(x) || differs(y)) {
      report(names[r], estimates[0][r].value, estimates[1][r].value, ", unlike the other recordings");
    }
  }
  return findings;
}

}  // namespace fathom::consistency
