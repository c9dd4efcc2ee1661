// Conventions that were mistaken are named as what they are, one cause for one slip, and no healthy sensor is touched.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <string>

#include "common/base/spatial.hpp"
#include "common/base/units.hpp"
#include "common/consistency/summary.hpp"
#include "common/tables/import.hpp"
#include "test/support/consistency.hpp"

namespace fathom {
namespace {

using consistency::ConsistencyResult;
using test::find;
using test::print;

std::string file(const std::string& name) { return std::string(FATHOM_SOURCE_DIR) + "/test/data/conventions/" + name; }

Recording table(const std::string& name, const std::string& map = "",
                const tables::SimulatedAxes& axes = {true, true, true, true, true, true}) {
  return tables::import_csv(file(name), map.empty() ? "" : file(map), axes).recording;
}
constexpr tables::SimulatedAxes kPlanar{true, true, false, false, false, true};

ConsistencyResult check_tables(const std::vector<Recording>& runs) {
  ConsistencyResult result = consistency::check_consistency(runs);
  print(result.findings);
  return result;
}

/// Neither of the two sensors that were right is altered.
bool untouched(const estimation::SensorFault& fault) {
  return (fault.matrix() - Eigen::Matrix3d::Identity()).norm() < 0.05;
}

}  // namespace

TEST_CASE("conventions: headings zeroed by each run are corrected by each run's own angle, and the runs disagree") {
  const ConsistencyResult result = check_tables({table("heading_a.csv"), table("heading_b.csv")});
  constexpr double kClose = 1.0 * kDegree;  // noise of 5 mrad, 90 s
  REQUIRE(result.corrections.size() == 2);
  CHECK(std::abs(std::abs(result.corrections[0].heading) - 27.0 * kDegree) < kClose);
  CHECK(std::abs(std::abs(result.corrections[1].heading) - 15.0 * kDegree) < 2.0 * kClose);
  CHECK(result.corrections[0].heading * result.corrections[1].heading < 0.0);
  const auto told = std::ranges::count(result.findings, "heading_offset", &ConsistencyFinding::finding);
  CHECK(told == 2);
  const ConsistencyFinding* one = find(result.findings, "pose_capture.attitude", "heading_offset");
  REQUIRE(one != nullptr);
  CHECK(one->evidence.find("the runs disagree") != std::string::npos);
}

TEST_CASE("conventions: velocities along the world's axes are named and turned, rates too where they are") {
  for (const auto& [name, map] :
       {std::pair{"world_velocity.csv", "quaternion_map.yaml"}, {"world_velocity_euler.csv", ""}}) {
    CAPTURE(name);
    const ConsistencyResult result = check_tables({table(name, map)});
    CHECK(find(result.findings, "dvl", "in_world_axes") != nullptr);
    CHECK(result.findings.size() == 1);
    CHECK(result.corrections[0].velocity_frame == estimation::VectorFrame::kWorld);
    CHECK(untouched(result.corrections[0].gyro));
    CHECK(untouched(result.corrections[0].dvl));
  }
  const ConsistencyResult both = check_tables({table("world_twist.csv", "quaternion_map.yaml")});
  CHECK(find(both.findings, "dvl and gyro", "in_world_axes") != nullptr);
  CHECK(both.findings.size() == 1);
  CHECK(both.corrections[0].rates_frame == estimation::VectorFrame::kWorld);
}

TEST_CASE("conventions: an east-north-up position is one turn, and the velocity log is left alone") {
  const ConsistencyResult result = check_tables({table("enu_position.csv")});
  const ConsistencyFinding* one = find(result.findings, "pose_capture.position", "axes");
  REQUIRE(one != nullptr);
  CHECK(one->evidence.find("east, north, up") != std::string::npos);
  CHECK(one->action.find("frame: ENU") != std::string::npos);
  CHECK(result.findings.size() == 1);
  CHECK(result.corrections[0].position_axes.determinant() > 0.0);
  CHECK(untouched(result.corrections[0].dvl));
  CHECK(untouched(result.corrections[0].gyro));
}

TEST_CASE("conventions: a heading counted from east is one cause, and gyro and position are left alone") {
  const ConsistencyResult result = check_tables({table("yaw_from_east.csv")});
  CHECK(find(result.findings, "pose_capture.attitude", "heading_from_east") != nullptr);
  CHECK(result.findings.size() == 1);
  CHECK(result.corrections[0].position_axes.isIdentity());
  CHECK(untouched(result.corrections[0].gyro));
  CHECK(untouched(result.corrections[0].dvl));
}

TEST_CASE("distance: at one speed a position half again too long is never called agreement, and nobody is corrected") {
  for (const auto& [name, ratio] : {std::pair{"circle_150.csv", 1.5}, {"circle_111.csv", 1.11}}) {
    CAPTURE(name);
    const ConsistencyResult result = check_tables({table(name, "", kPlanar)});
    const ConsistencyFinding* one = find(result.findings, "pose_capture.position", "distance");
    REQUIRE(one != nullptr);
    CHECK(one->size == doctest::Approx(ratio).epsilon(0.02));
    CHECK(one->evidence.find("projection") != std::string::npos);
    CHECK(result.corrections[0].position_scale == 1.0);
    CHECK(untouched(result.corrections[0].dvl));
    CHECK(consistency::conclusion_of(result).empty());
  }
}

TEST_CASE("agreement is only said where a fault of practical size would have been seen") {
  const auto said = [](const test::SyntheticOptions& options) {
    const auto checked = test::check(options);
    CHECK(checked.findings().empty());
    return consistency::conclusion_of(checked.result);
  };
  const std::string still = said({.seed = 3, .duration = 60.0, .activity = {0, 0, 0, 0, 0, 0}});
  CHECK(still.find("agree") == std::string::npos);
  const std::string planar = said({.seed = 3, .duration = 120.0, .activity = {1, 1, 0, 0, 0, 1}});
  CHECK(planar.find("nobody can tell") != std::string::npos);
  CHECK(planar.find("gyro.p axis") != std::string::npos);
}

TEST_CASE("conventions: a craft at rest, level and accelerometer two degrees apart, says nothing of their axes") {
  std::mt19937 random{5};
  std::normal_distribution<double> normal;
  const auto noise = [&](double sigma) {
    return Eigen::Vector3d{sigma * normal(random), sigma * normal(random), sigma * normal(random)};
  };
  // Tilts of a vehicle on the shore; the zero of a cheap accelerometer.
  for (const Eigen::Vector2d& tilt : {Eigen::Vector2d{1.5, -1.0}, {-2.0, 2.0}, {0.3, 2.5}}) {
    for (const Eigen::Vector3d& zero : {Eigen::Vector3d{0.25, -0.2, 0.1}, {-0.2, -0.3, 0.0}, {0.3, 0.2, -0.1}}) {
      Recording run{.name = "shore"};
      for (int k = 0; k < 600; ++k) {
        const double swing = 0.1 * kDegree * std::sin(0.3 * k);  // people walk by
        const Eigen::Vector3d angles{tilt.x() * kDegree + swing, tilt.y() * kDegree - 0.5 * swing, 0.7};
        const Eigen::Quaterniond q_WB{rotation_from_euler(angles)};
        run.ahrs.push_back({.utime = 100'000 * k,
                            .w_WB_B = noise(0.001),
                            .f_B = q_WB.conjugate() * Eigen::Vector3d{0.0, 0.0, -9.81} + zero + noise(0.02),
                            .q_WB = q_WB,
                            .has_rates = true,
                            .has_specific_force = true,
                            .has_attitude = true});
      }
      const ConsistencyResult result = consistency::check_consistency(std::span(&run, 1));
      print(result.findings);
      CHECK(result.corrections[0].attitude_axes.isIdentity());
      CHECK(result.corrections[0].attitude_world.isIdentity());
      CHECK(untouched(result.corrections[0].gyro));
    }
  }
}

TEST_CASE("conventions: a boat's heading is never taken for a quaternion in another order, whatever contradicts it") {
  // A track straight to the north-east; a course from another instrument, which drifts away by 30 degrees.
  Recording run{.name = "boat"};
  for (int k = 0; k < 600; ++k) {
    const double t = 0.1 * k, heading = (60.0 + 0.5 * t) * kDegree, course = (45.0 + 0.5 * t) * kDegree;
    const Eigen::Quaterniond q_WB{rotation_from_euler({0.0, 0.0, heading})};
    const Utime utime = 100'000 * k;
    run.pose_capture.push_back({.utime = utime,
                                .p_WB = {0.8 * t, 0.8 * t, 0.0},
                                .q_WB = q_WB,
                                .valid = true,
                                .has_position = true,
                                .has_attitude = true});
    run.dvl.push_back(
        {.utime = utime,
         .v_WB_B = q_WB.conjugate() * Eigen::Vector3d{1.1 * std::cos(course), 1.1 * std::sin(course), 0.0},
         .valid = true});
  }
  const ConsistencyResult result = consistency::check_consistency(std::span(&run, 1));
  print(result.findings);
  CHECK(result.corrections[0].quaternion == estimation::QuaternionForm::kAsRead);
  CHECK(result.corrections[0].attitude_axes(2, 2) * result.corrections[0].attitude_world(2, 2) > 0.5);
}

TEST_CASE(
    "conventions: where attitude and gyro contradict each other and nothing else speaks, the gyro's mount is turned") {
  // Six degrees of freedom, no velocity log: which of the two is turned about z these data cannot say.
  Recording run = test::synthetic_recording({.seed = 3, .duration = 60.0});
  run.dvl.clear();
  for (Ahrs& one : run.ahrs) one.w_WB_B = Eigen::Vector3d{-1.0, -1.0, 1.0}.cwiseProduct(one.w_WB_B);
  const ConsistencyResult result = consistency::check_consistency(std::span(&run, 1));
  print(result.findings);
  CHECK(result.corrections[0].attitude_axes.isIdentity());
  CHECK(result.corrections[0].gyro.base.isApprox(Eigen::Matrix3d{Eigen::Vector3d{-1.0, -1.0, 1.0}.asDiagonal()}));
}

}  // namespace fathom
