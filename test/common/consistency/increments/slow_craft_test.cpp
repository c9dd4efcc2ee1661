// A ship turns and drifts within tens of seconds, and drifts as it turns: its velocity's scale, the arm of the log and
// the log's delay then do nearly the same. What the motion hides must not be told of the instruments.
#include <doctest/doctest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <random>

#include "common/consistency/increments/increment_estimate.hpp"
#include "common/consistency/pairs/pair.hpp"

namespace fathom::consistency {
namespace {

constexpr double kStep = 0.1;  // s
constexpr int kSamples = 6000;
constexpr int kSeeds = 12;
constexpr double kSway = -1.2, kLag = 2.0;  // m/s of drift per rad/s of turn, s after it: then a log that is late by d
                                            // reads 1 - d / kLag of the drift, with an arm of kSway d / kLag
constexpr int kScale = 4, kArm = 12;        // of theta: M(1, 1), and x of the arm behind nine of M and three biases

/// A zigzag whose legs differ, at .6 m/s; noise of a tracking system, a velocity log and a gyro.
IncrementFit seen(unsigned seed) {
  std::mt19937 random{seed};
  std::normal_distribution<double> unit;
  PoseSeries pose;
  Series log, rates;
  double yaw = 0.0, v = 0.0;  // rad, m/s
  Eigen::Vector3d p_WB = Eigen::Vector3d::Zero();
  constexpr int kFine = 10;
  for (int i = 0; i < kFine * kSamples; ++i) {
    const double h = kStep / kFine, t = i * h;
    const double rate = 0.06 * std::sin(0.21 * t + 0.8 * std::sin(0.017 * t)) + 0.03 * std::sin(0.37 * t);
    const double u = 0.6 + 0.05 * std::sin(0.05 * t);
    if (i % kFine == 0) {
      pose.t.push_back(t);
      pose.p_WB.push_back(p_WB + 0.01 * Eigen::Vector3d{unit(random), unit(random), 0.0});
      pose.q_WB.emplace_back(Eigen::AngleAxisd{yaw + 0.002 * unit(random), Eigen::Vector3d::UnitZ()});
      pose.valid.push_back(1);
      log.t.push_back(t);
      log.x.emplace_back(u + 0.004 * unit(random), v + 0.004 * unit(random), 0.0);
      rates.t.push_back(t);
      rates.x.emplace_back(0.0, 0.0, rate + 0.0005 * unit(random));
    }
    const double sway = v + 0.5 * h / kLag * (kSway * rate - v), ahead = yaw + 0.5 * h * rate;  // in the step's middle
    p_WB += h * Eigen::Vector3d{u * std::cos(ahead) - sway * std::sin(ahead),
                                u * std::sin(ahead) + sway * std::cos(ahead), 0.0};
    v += h / kLag * (kSway * rate - v);
    yaw += h * rate;
  }
  estimation::make_continuous(pose.q_WB);
  pose.has_position = pose.has_attitude = true;
  return fit_increments(velocity_problem(pose, &rates), log, {});
}

}  // namespace

TEST_CASE(
    "slow craft: where its motion hides a delay, scale and arm are those of none, and as sure as it lets them be") {
  double scales = 0.0, arms = 0.0, farthest = 0.0;
  for (unsigned seed = 1; seed <= kSeeds; ++seed) {
    const IncrementFit fit = seen(seed);
    REQUIRE(fit.ok);
    CHECK(!fit.delay_found);
    const Estimate scale = estimate(
        fit, [](const Eigen::VectorXd& theta) { return theta[kScale]; }, true);
    const Estimate arm = estimate(
        fit, [](const Eigen::VectorXd& theta) { return theta[kArm]; }, true);
    scales += std::pow((scale.value - 1.0) / scale.sigma, 2) / kSeeds;
    arms += std::pow(arm.value / arm.sigma, 2) / kSeeds;
    farthest = std::max(farthest, std::abs(arm.value));
  }
  MESSAGE("scale " << scales << ", arm " << arms << ", farthest arm " << farthest << " m");
  CHECK(scales < 1.8);  // one in a hundred of chi squared over its twelve
  CHECK(arms < 1.8);
  CHECK(farthest < 0.03);
}

}  // namespace fathom::consistency
