// A column of zeros beside a pose that moves is no measurement; what rests, and what is noisy, is left alone.
#include "common/consistency/dead_axes.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <random>

namespace fathom::consistency {
namespace {

constexpr std::array<bool, 6> kFour{true, true, true, false, false, true};

/// Two minutes of a vehicle that swings about north with .3 rad and goes to and fro, poses noisy; sensors are exact.
Recording swinging(double turn = 0.3, double way = 0.5) {
  std::mt19937 random{7};
  std::normal_distribution<double> normal;
  Recording recording{.name = "dive"};
  for (int i = 0; i < 2400; ++i) {
    const double t = 0.05 * i;
    const auto utime = static_cast<Utime>(1e6 * t);
    const double psi = turn * std::sin(0.5 * t), r = 0.5 * turn * std::cos(0.5 * t);
    const double x = way * std::sin(0.3 * t), x_dot = 0.3 * way * std::cos(0.3 * t);
    PoseCapture pose{.utime = utime};
    pose.p_WB = {x + 0.005 * normal(random), 0.005 * normal(random), 1.0 + 0.005 * normal(random)};
    pose.q_WB = Eigen::AngleAxisd(psi + 0.0035 * normal(random), Eigen::Vector3d::UnitZ());
    recording.pose_capture.push_back(pose);
    Ahrs ahrs{.utime = utime, .has_rates = true};
    ahrs.w_WB_B = {0.001 * normal(random), 0.001 * normal(random), r};
    recording.ahrs.push_back(ahrs);
    Dvl dvl{.utime = utime};
    dvl.v_WB_B = {x_dot * std::cos(psi), -x_dot * std::sin(psi), 0.0};
    recording.dvl.push_back(dvl);
  }
  return recording;
}

}  // namespace

TEST_CASE("dead axes: nothing is set aside where all that moves is measured") {
  std::vector<Recording> one{swinging()};  // w rests at zero, and so does z
  CHECK(set_aside_dead_axes(one, kFour).empty());
  CHECK(one[0].dvl.size() == 2400);
  CHECK(one[0].ahrs[0].has_rates);
}

TEST_CASE("dead axes: a gyro that says one number while the attitude turns is named and not used") {
  for (const double value : {0.0, 0.02}) {
    std::vector<Recording> runs{swinging(), swinging()};
    for (Ahrs& ahrs : runs[1].ahrs) ahrs.w_WB_B.z() = value;
    runs[1].name = "second";
    const auto findings = set_aside_dead_axes(runs, kFour);
    REQUIRE(findings.size() == 1);
    CHECK(findings[0].run == "second");
    CHECK(findings[0].signal == "gyro.r");
    CHECK(findings[0].finding == "dead");
    CHECK(findings[0].size == doctest::Approx(0.15 / std::sqrt(2.0)).epsilon(0.2));
    CHECK_FALSE(runs[1].ahrs[0].has_rates);
    CHECK(runs[0].ahrs[0].has_rates);
    CHECK_FALSE(runs[1].dvl.empty());
  }
}

TEST_CASE("dead axes: a velocity that stays while the position goes on") {
  std::vector<Recording> one{swinging()};
  for (Dvl& dvl : one[0].dvl) dvl.v_WB_B.x() = 0.0;
  const auto findings = set_aside_dead_axes(one, kFour);
  REQUIRE(findings.size() == 1);
  CHECK(findings[0].signal == "dvl.u");
  CHECK(one[0].dvl.empty());
  std::vector<Recording> turning{swinging()};
  for (Dvl& dvl : turning[0].dvl) dvl.v_WB_B.x() = 0.0;
  CHECK(set_aside_dead_axes(turning, {false, false, false, false, false, true}).empty());  // nobody simulates surge
}

TEST_CASE("dead axes: noise of the pose is no motion, and a few samples are no proof") {
  std::vector<Recording> resting{swinging(0.0, 0.0)};
  for (Ahrs& ahrs : resting[0].ahrs) ahrs.w_WB_B.setZero();
  for (Dvl& dvl : resting[0].dvl) dvl.v_WB_B.setZero();
  CHECK(set_aside_dead_axes(resting, kFour).empty());
  std::vector<Recording> few{swinging()};
  few[0].ahrs.resize(20);
  for (Ahrs& ahrs : few[0].ahrs) ahrs.w_WB_B.setZero();
  CHECK(set_aside_dead_axes(few, kFour).empty());
  std::vector<Recording> blind{swinging()};
  blind[0].pose_capture.clear();
  for (Ahrs& ahrs : blind[0].ahrs) ahrs.w_WB_B.setZero();
  CHECK(set_aside_dead_axes(blind, kFour).empty());
}

}  // namespace fathom::consistency
