// How streams are read as they were meant: headings counted otherwise, vectors along the world's axes, a late position.
#include "common/estimation/corrections.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <numbers>

#include "common/base/spatial.hpp"

namespace fathom::estimation {
namespace {

constexpr double kRounding = 1e-9;

PoseSeries yawing() {  // 1 rad/s about the vertical, at 10 Hz, 1 m/s north
  PoseSeries pose;
  for (int k = 0; k <= 20; ++k) {
    pose.t.push_back(0.1 * k);
    pose.p_WB.emplace_back(0.1 * k, 0.0, 0.0);
    pose.q_WB.emplace_back(Eigen::AngleAxisd(0.1 * k, Eigen::Vector3d::UnitZ()));
    pose.valid.push_back(1);
  }
  pose.has_position = pose.has_attitude = true;
  return pose;
}

}  // namespace

TEST_CASE("corrections: a heading counted from east or anticlockwise, roll and pitch as they are") {
  const Eigen::Vector3d logged(0.1, -0.2, 0.3);
  const Eigen::Quaterniond q(rotation_from_euler(logged));
  const auto read = [&](HeadingSense sense) { return euler_from_rotation(as_meant(sense, q).toRotationMatrix()); };
  CHECK((read(HeadingSense::kAsRead) - logged).norm() < kRounding);
  CHECK((read(HeadingSense::kFromEast) - Eigen::Vector3d(0.1, -0.2, 0.5 * std::numbers::pi - 0.3)).norm() < kRounding);
  CHECK((read(HeadingSense::kAnticlockwise) - Eigen::Vector3d(0.1, -0.2, -0.3)).norm() < kRounding);
}

TEST_CASE(
    "corrections: a vector along the world's axes is turned by the attitude of its moment, and goes without one") {
  Series north{.t = {0.55, 1.0, 9.0}, .x = {{1, 0, 0}, {1, 0, 0}, {1, 0, 0}}};
  to_body(VectorFrame::kWorld, Eigen::Matrix3d::Identity(), yawing(), north);
  REQUIRE(north.size() == 2);
  CHECK((north.x[0] - Eigen::Vector3d(std::cos(0.55), -std::sin(0.55), 0.0)).norm() < kRounding);
  Series logged{.t = {1.0}, .x = {{1, 2, 3}}};
  to_body(VectorFrame::kBody, Eigen::Matrix3d::Identity(), yawing(), logged);
  CHECK(logged.x[0] == Eigen::Vector3d(1, 2, 3));
}

TEST_CASE("corrections: rates of Euler angles by hand") {
  // Pitched up by 30 deg a turn in yaw is felt half as roll the other way.
  const Eigen::Quaterniond q(rotation_from_euler({0.0, std::numbers::pi / 6.0, 0.4}));
  CHECK((body_rates({0.0, 0.0, 2.0}, q) - Eigen::Vector3d(-1.0, 0.0, std::sqrt(3.0))).norm() < kRounding);
  CHECK((body_rates({1.0, 2.0, 0.0}, q) - Eigen::Vector3d(1.0, 2.0, 0.0)).norm() < kRounding);
}

TEST_CASE("corrections: a position that is late is drawn forward to its attitude") {
  PoseSeries pose = yawing();
  Corrections corrections;
  corrections.position_late = 0.25;
  correct_pose(corrections, pose);
  CHECK(pose.p_WB[4].x() == doctest::Approx(0.65));
  CHECK(pose.valid[4] == 1);
  CHECK(pose.valid.back() == 0);  // what it should be was not logged any more
}

}  // namespace fathom::estimation
