// Lever arms and couplings where the vehicle turns about one axis alone: what that determines is found, what noise
// alone determines is not said.
#include <doctest/doctest.h>

#include <cmath>
#include <cstdio>
#include <random>

#include "common/consistency/pairs/pair_comparison.hpp"
#include "test/support/consistency.hpp"

namespace fathom {

using test::check;
using test::find;
using test::print;
using test::SyntheticOptions;

namespace {

constexpr std::array<double, 6> kYawOnly{1, 1, 1, 0, 0, 1};

/// Noise with a memory on the rates of axes that do not turn, as gyros on a shaking frame have.
auto wandering(unsigned seed, double size, double share) {
  return [random = std::mt19937(seed), normal = std::normal_distribution<double>(), size, share,
          state = Eigen::Vector2d(Eigen::Vector2d::Zero())](Ahrs& ahrs, double) mutable {
    const Eigen::Vector2d white(normal(random), normal(random));
    state = share * state + std::sqrt(1.0 - share * share) * white;
    ahrs.w_WB_B.head<2>() += size * state;
  };
}

int couplings(const std::vector<ConsistencyFinding>& findings) {
  int count = 0;
  for (const ConsistencyFinding& one : findings) count += one.finding == "rate_coupling";
  return count;
}

}  // namespace

TEST_CASE("lever arm: yaw alone tells its horizontal parts, within their stated errors, and leaves the third alone") {
  std::mt19937 random(21);
  std::uniform_real_distribution<double> any(-0.3, 0.3);
  int covered = 0;
  constexpr unsigned kSeeds = 16;
  constexpr double kWorst = 0.01;      // m
  constexpr double kNinetyFive = 2.4;  // of Student's law with 7 degrees of freedom
  constexpr double kSmall = 0.05;      // m: surely found at this noise
  for (unsigned seed = 1; seed <= kSeeds; ++seed) {
    Eigen::Vector3d lever(any(random), any(random), any(random));
    for (int k = 0; k < 2; ++k) lever[k] += std::copysign(kSmall, lever[k]);
    SyntheticOptions options{.seed = seed, .activity = kYawOnly, .dvl_lever = lever};
    if (seed % 2 == 0) options.spoil_gyro = wandering(seed, 0.01, 0.9);
    const auto checked = check(options);
    const auto& findings = checked.findings();
    CAPTURE(seed);
    for (int k = 0; k < 2; ++k) {
      const ConsistencyFinding* one = find(findings, "dvl", k == 0 ? "lever_arm_x" : "lever_arm_y");
      REQUIRE(one != nullptr);
      covered += std::abs(one->size - lever[k]) < kNinetyFive * one->std;
      CHECK(std::abs(one->size - lever[k]) < kWorst);
      CHECK(one->evidence.find("unknown") != std::string::npos);
      CHECK(checked.result.corrections[0].dvl.lever[k] == one->size);
    }
    CHECK(checked.result.corrections[0].dvl.lever.z() == 0.0);
    CHECK(checked.result.corrections[0].dvl.coupling.isZero());
    CHECK(findings.size() == 2);
    if (findings.size() != 2) print(findings);
  }
  std::printf("coverage of lever arms by yaw alone: %d of %u\n", covered, 2 * kSeeds);
  CHECK(covered >= 26);  // of 32: chance of fewer is under 1 % when 95 % are covered
}

TEST_CASE("lever arm: none is found, and no coupling, where there is none and rates of still axes are noise") {
  int false_alarms = 0;
  constexpr unsigned kSeeds = 24;
  for (unsigned seed = 1; seed <= kSeeds; ++seed) {
    SyntheticOptions options{.seed = seed, .activity = kYawOnly};
    if (seed % 3 > 0) options.spoil_gyro = wandering(seed, seed % 3 == 1 ? 0.01 : 0.03, seed % 2 == 0 ? 0.9 : 0.99);
    const auto checked = check(options);
    CHECK(couplings(checked.findings()) == 0);
    for (const ConsistencyFinding& one : checked.findings()) {
      if (one.signal != "dvl") continue;
      ++false_alarms;
      print({one});
    }
  }
  CHECK(false_alarms <= 1);  // of 24, at four sigmas
}

TEST_CASE("lever arm: a symmetric coupling to rates that are turned about is still told from it") {
  SyntheticOptions options{.seed = 13, .dvl_lever = {0.3, 0.0, -0.4}};
  const test::SyntheticMotion motion(options.seed);
  Eigen::Matrix3d coupling = Eigen::Matrix3d::Zero();
  coupling(0, 2) = coupling(2, 0) = 0.15;  // m
  options.spoil_dvl = [&](Dvl& dvl, double t) { dvl.v_WB_B -= coupling * motion.w_B(t); };
  const auto checked = check(options);
  print(checked.findings());
  CHECK(couplings(checked.findings()) == 1);
  CHECK((checked.result.corrections[0].dvl.coupling - coupling).norm() < 0.03);
  test::check_motion(checked);
}

}  // namespace fathom
