// A vehicle that hangs in the water tells a tilted world from its own trim, and tells nothing where it cannot.
#include <doctest/doctest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "common/base/spatial.hpp"
#include "common/base/units.hpp"
#include "common/consistency/consistency.hpp"
#include "test/support/consistency.hpp"

namespace fathom::consistency {
namespace {

constexpr double kStep = 0.1;  // s

struct Hanging {
  unsigned seed{1};
  double duration{480.0};                         // s
  Eigen::Vector2d tilt{Eigen::Vector2d::Zero()};  // rad: where down leans in the measured world
  Eigen::Vector2d trim{2.0 * kDegree, -3.0 * kDegree};
  double swing{1.0 * kDegree};  // of roll and pitch, with a memory of some seconds
  double turning{0.05};         // rad/s, to and fro
  double drift{};               // rad of trim over the whole run
  double slope{};               // rad of pitch that is driven by the heading, while moving
};

PoseSeries pose_of(const Hanging& o) {
  std::mt19937 random{o.seed};
  std::normal_distribution<double> normal;
  PoseSeries pose;
  pose.has_position = pose.has_attitude = true;
  Eigen::Vector2d swing = Eigen::Vector2d::Zero();
  double heading = 6.0 * normal(random), rate = o.turning;
  const double memory = std::exp(-kStep / 4.0);
  Eigen::Vector3d p = Eigen::Vector3d::Zero();
  const Eigen::Quaterniond T =
      Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitZ(), Eigen::Vector3d(o.tilt.x(), o.tilt.y(), 1.0));
  for (double t = 0.0; t < o.duration; t += kStep) {
    swing =
        memory * swing + std::sqrt(1.0 - memory * memory) * o.swing * Eigen::Vector2d(normal(random), normal(random));
    if (std::fmod(t, 25.0) < 0.5 * kStep) rate = normal(random) > 0.0 ? o.turning : -o.turning;
    heading += kStep * rate;
    const bool moves = o.slope != 0.0;
    const double share = t / o.duration;
    const Eigen::Matrix3d R =
        rotation_from_euler({o.trim.x() + swing.x() + o.drift * share,
                             o.trim.y() + swing.y() - o.drift * share + o.slope * std::cos(heading), heading});
    if (moves) p += kStep * 0.4 * R.col(0);
    pose.t.push_back(t);
    pose.p_WB.push_back(p);
    pose.q_WB.push_back(T * Eigen::Quaterniond(R));
    pose.valid.push_back(1);
  }
  make_continuous(pose.q_WB);
  return pose;
}

std::vector<ConsistencyFinding> level_of(const std::vector<PoseSeries>& poses) {
  std::vector<std::string> names;
  for (std::size_t r = 0; r < poses.size(); ++r) names.push_back("run-" + std::to_string(r));
  return compare_with_vertical("pose_capture.attitude", names, poses);
}

std::vector<ConsistencyFinding> level(const Hanging& hanging) { return level_of({pose_of(hanging)}); }

}  // namespace

TEST_CASE("level check: a tilted world is found with its size, the vehicle's trim is not taken for it") {
  const Eigen::Vector2d tilt(2.5 * kDegree, -1.5 * kDegree);
  for (unsigned seed = 1; seed <= 5; ++seed) {
    const auto findings = level({.seed = seed, .tilt = tilt});
    test::print(findings);
    REQUIRE(findings.size() == 1);
    CHECK(findings[0].finding == "tilt");
    CHECK(findings[0].run == "all");
    CHECK(std::abs(findings[0].size - tilt.norm()) < 0.6 * kDegree);  // three sigmas of the swing over 480 s
  }
  // Towards where, by hand: the numbers stand in the evidence. Without swing they are exact to second order.
  const auto exact = level({.tilt = {3.0 * kDegree, 0.0}, .swing = 0.01 * kDegree});
  REQUIRE(exact.size() == 1);
  CHECK(exact[0].size == doctest::Approx(3.0 * kDegree).epsilon(0.02));
  CHECK(exact[0].evidence.find("leant 3.0") != std::string::npos);
}

TEST_CASE("level check: no false alarm over many seeds") {
  int alarms = 0;
  constexpr unsigned kSeeds = 200;
  for (unsigned seed = 1; seed <= kSeeds; ++seed) {
    Hanging hanging{.seed = 1000 + seed, .duration = 400.0 + 20.0 * (seed % 20), .swing = (seed % 4) * kDegree};
    if (seed % 3 == 0) hanging.turning = 0.02;
    if (seed % 5 == 0) hanging.drift = 3.0 * kDegree;
    const auto findings = level(hanging);
    alarms += static_cast<int>(findings.size());
    if (!findings.empty()) std::printf("seed %u\n", seed);
    test::print(findings);
  }
  CHECK(alarms == 0);
}

TEST_CASE("level check: where the data cannot tell, nothing is said") {
  const Eigen::Vector2d tilt(3.0 * kDegree, 0.0);
  CHECK(level({.tilt = tilt, .turning = 0.0}).empty());                           // one heading: trim or tilt
  CHECK(level({.duration = 60.0, .tilt = tilt}).empty());                         // too short
  CHECK(level({.slope = 5.0 * kDegree}).empty());                                 // driven along a slope, not at rest
  CHECK(level({.tilt = tilt, .swing = 25.0 * kDegree}).empty());                  // swings far too much
  CHECK(level({.tilt = {0.2 * kDegree, 0.0}, .swing = 0.05 * kDegree}).empty());  // too small to matter
  CHECK(level_of(std::vector<PoseSeries>{}).empty());
  CHECK(level_of(std::vector<PoseSeries>{PoseSeries{}}).empty());
}

TEST_CASE("level check: one recording in another world is named") {
  const auto findings = level_of(
      {pose_of({.seed = 1}), pose_of({.seed = 2}), pose_of({.seed = 3, .tilt = {0.15, 0.0}}), pose_of({.seed = 4})});
  test::print(findings);
  REQUIRE(findings.size() == 1);
  CHECK(findings[0].run == "run-2");
  CHECK(findings[0].size == doctest::Approx(0.15).epsilon(0.15));
}

}  // namespace fathom::consistency
