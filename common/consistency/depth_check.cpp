// Depth sensor against the vertical of the position: z = scale * depth(t + delay) + offset.
#include <algorithm>
#include <cmath>
#include <limits>

#include "common/base/statistics.hpp"
#include "common/consistency/consistency.hpp"
#include "common/estimation/wording.hpp"

namespace fathom::consistency {
namespace {

constexpr double kScaleFloor = 0.02;
constexpr double kDelayFloor = 0.05;   // s: depth changes slowly
constexpr double kLongestDelay = 1.0;  // s
constexpr double kDelayStep = 0.02;    // s
constexpr double kDelayGain = 20.0;  // nats by which a delay must explain the depth better; one number a second counts
constexpr double kBlocks = 12;
constexpr double kLeastMotion = 8.0;  // depth must move by this many sigmas of the misfit

struct Line {
  double scale{}, offset{}, misfit{std::numeric_limits<double>::infinity()};
};

/// Huber-weighted line through pairs (depth, z), without block `without`.
Line fit_line(const std::vector<std::pair<double, double>>& pairs, int without) {
  Line line;
  double sigma = 0.0;
  for (int pass = 0; pass < 3; ++pass) {
    double w0 = 0, wx = 0, wy = 0, wxx = 0, wxy = 0;
    for (std::size_t i = 0; i < pairs.size(); ++i) {
      if (static_cast<int>(static_cast<double>(i) * kBlocks / static_cast<double>(pairs.size())) == without) continue;
      const auto& [x, y] = pairs[i];
      const double w = pass == 0 || sigma <= 0.0 ? 1.0 : huber_weight((y - line.scale * x - line.offset) / sigma);
      w0 += w, wx += w * x, wy += w * y, wxx += w * x * x, wxy += w * x * y;
    }
    const double spread = wxx - wx * wx / w0;
    if (!(spread > 0.0)) return line;
    line.scale = (wxy - wx * wy / w0) / spread;
    line.offset = (wy - line.scale * wx) / w0;
    std::vector<double> misfit;
    misfit.reserve(pairs.size());
    for (const auto& [x, y] : pairs) misfit.push_back(y - line.scale * x - line.offset);
    sigma = mad_sigma(std::move(misfit));
  }
  line.misfit = sigma;
  return line;
}

}  // namespace

std::vector<ConsistencyFinding> compare_depth(const RunSignals& run, const PoseSeries& pose) {
  std::vector<ConsistencyFinding> findings;
  if (run.depth.size() < 100 || !pose.has_position) return findings;
  const Spline spline(run.depth);
  const auto pairs_at = [&](double delay) {
    std::vector<std::pair<double, double>> pairs;
    Eigen::Vector3d depth;
    for (std::size_t i = 0; i < pose.size(); ++i) {
      if (pose.valid[i] && spline.at(pose.t[i] + delay, depth)) pairs.emplace_back(depth.z(), pose.p_WB[i].z());
    }
    return pairs;
  };
  Line best;
  double delay = 0.0, misfit_without = std::numeric_limits<double>::infinity();
  for (double trial = -kLongestDelay; trial <= kLongestDelay + 1e-9; trial += kDelayStep) {
    const auto pairs = pairs_at(trial);
    const Line line = pairs.size() < 100 ? Line{} : fit_line(pairs, -1);
    if (std::abs(trial) < 0.5 * kDelayStep) misfit_without = line.misfit;
    if (line.misfit < 0.98 * best.misfit || (line.misfit < 1.02 * best.misfit && std::abs(trial) < std::abs(delay))) {
      best = line;
      delay = trial;
    }
  }
  const auto pairs = pairs_at(delay);
  std::vector<double> z;
  z.reserve(pairs.size());
  for (const auto& pair : pairs) z.push_back(pair.second);
  if (z.size() < 100 || mad_sigma(z) < kLeastMotion * best.misfit || mad_sigma(z) < 0.02) return findings;
  std::vector<double> scales;
  scales.reserve(static_cast<std::size_t>(kBlocks));
  for (int block = 0; block < static_cast<int>(kBlocks); ++block) scales.push_back(fit_line(pairs, block).scale);
  const double sigma = jackknife_sigma(scales);
  const std::string evidence = text("position z = %.5g depth %+.3g m, scale +- %.2g, misfit %.3g m, delay %.2f s",
                                    best.scale, best.offset, sigma, best.misfit, delay);
  const auto report = [&](const char* what, double size, const char* unit) {
    findings.push_back({.run = run.name,
                        .signal = "depth",
                        .reference = "pose_capture",
                        .finding = what,
                        .size = size,
                        .unit = unit,
                        .evidence = evidence,
                        .action = "reported only: the pose's z is used"});
  };
  if (best.scale < 0.0) report("sign", -1.0, "");
  const double size = std::abs(best.scale);
  if (std::abs(size - 1.0) > std::max(kScaleFloor, 6.0 * sigma))
    report(size < 0.4 || size > 2.5 ? "unit" : "scale", size, "");
  const double gain = (pose.t.back() - pose.t.front()) * std::log(misfit_without / best.misfit);
  if (std::abs(delay) > kDelayFloor && gain > kDelayGain) report("delay", delay, "s");
  return findings;
}

}  // namespace fathom::consistency
