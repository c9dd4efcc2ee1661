// What each aid says by itself: with exact measurements it is the motion itself, whatever the attitude and the mounts.
#include "common/estimation/smoothing/aids_seen.hpp"

#include <doctest/doctest.h>

#include <cmath>

#include "common/base/spatial.hpp"
#include "common/estimation/smoothing/state_as_measured.hpp"

using namespace fathom;
using namespace fathom::estimation;

namespace {

constexpr double kExact = 1e-9;  // m, m/s: rounding

struct Fixture {
  model::Mounts mounts;
  model::Site site;
  Recording recording;
  Eigen::Vector3d p_WB{0.3, -0.2, 0.7}, v_B{0.2, -0.1, 0.05}, w_B{0.05, -0.02, 0.3};
  Eigen::Matrix3d R_WB = rotation_from_euler({0.05, -0.04, 0.9});
  model::Mount camera{.p_BS = {0.1, 0.02, 0.12}, .R_BS = rotation_from_euler({0.0, 0.0, 1.5})};

  Fixture() {
    mounts.cameras.push_back({.name = "down", .mount = camera, .width = 640, .height = 480, .focal = 500.0});
    site.floor = 1.5;
    site.tags.push_back({.id = 3, .size = 0.1, .p_WT = {0.4, 0.1, 1.5}, .R_WT = Eigen::Matrix3d::Identity()});
    StateEstimate state{.utime = 1'000'000, .p_WB = p_WB, .q_WB = Eigen::Quaterniond{R_WB}, .valid = true};
    state.nu << v_B, w_B;
    recording.state.push_back(state);
  }
  [[nodiscard]] Eigen::Vector3d in_camera(const Eigen::Vector3d& p_W) const {
    return camera.R_BS.transpose() * (R_WB.transpose() * (p_W - p_WB) - camera.p_BS);
  }
};

}  // namespace

TEST_CASE("aids seen: a tag gives the position, the laser's dot the depth") {
  Fixture f;
  f.recording.tag_pose.push_back(
      {.utime = 1'010'000, .camera = "down", .tag = 3, .p_CT = f.in_camera({0.4, 0.1, 1.5})});
  f.recording.laser_range.push_back({.utime = 1'010'000, .camera = "down", .p_CL = f.in_camera({0.35, -0.1, 1.5})});
  const AidsSeen seen = aids_seen(f.recording, f.mounts, f.site, 0);
  REQUIRE(seen.tags.x.size() == 1);
  CHECK((seen.tags.x[0] - f.p_WB).norm() < kExact);
  CHECK(seen.tags.t[0] == doctest::Approx(1.01));
  REQUIRE(seen.laser.x.size() == 1);
  CHECK(std::abs(seen.laser.x[0].z() - f.p_WB.z()) < kExact);
  CHECK(std::isnan(seen.laser.x[0].x()));
}

TEST_CASE("aids seen: the scene's motion gives u and v, and w where its growth was measured") {
  Fixture f;
  const Eigen::Vector3d v_C = f.camera.R_BS.transpose() * (f.v_B + f.w_B.cross(f.camera.p_BS));
  const Eigen::Vector3d down_B = f.R_WB.row(2).transpose();
  const double distance =
      (1.5 - f.p_WB.z() - down_B.dot(f.camera.p_BS)) / down_B.dot(Eigen::Vector3d{f.camera.R_BS.col(2)});
  f.recording.optical_flow.push_back({.utime = 1'000'000, .camera = "down", .flow_C = -v_C / distance});
  f.recording.optical_flow.push_back(f.recording.optical_flow.front());
  f.recording.optical_flow.back().covariance.setIdentity();
  const AidsSeen seen = aids_seen(f.recording, f.mounts, f.site, 0);
  REQUIRE(seen.flow.x.size() == 2);
  CHECK((seen.flow.x[0].head<2>() - f.v_B.head<2>()).norm() < kExact);
  CHECK(std::isnan(seen.flow.x[0].z()));  // the picture's growth was not measured
  CHECK((seen.flow.x[1] - f.v_B).norm() < kExact);
}

TEST_CASE("aids seen: what has no place, no tag on the map, or no state near it is left out") {
  Fixture f;
  f.recording.tag_pose.push_back({.utime = 1'000'000, .camera = "up", .tag = 3});
  f.recording.tag_pose.push_back({.utime = 1'030'000, .camera = "down", .tag = 99});
  f.recording.tag_pose.push_back({.utime = 9'000'000, .camera = "down", .tag = 3});
  f.recording.dvl.push_back({.utime = 1'000'000, .valid = false});
  f.recording.usbl.push_back({.utime = 1'000'000, .valid = false});
  const AidsSeen seen = aids_seen(f.recording, f.mounts, f.site, 0);
  CHECK(seen.tags.t.empty());
  CHECK(seen.dvl.t.empty());
  CHECK(seen.usbl.t.empty());
}

TEST_CASE("state as measured: stands in for a motion capture that is not there, and only then") {
  Fixture f;
  f.recording.ahrs.push_back({.has_rates = true, .has_specific_force = true});
  CHECK(take_state_as_measured(f.recording));
  CHECK(f.recording.ahrs.back().has_rates);
  CHECK_FALSE(f.recording.ahrs.back().has_specific_force);  // it is in STATE already
  REQUIRE(f.recording.pose_capture.size() == 1);
  CHECK(f.recording.pose_capture[0].p_WB == f.p_WB);
  CHECK(f.recording.dvl[0].v_WB_B == f.v_B);
  CHECK(f.recording.one_estimate);
  CHECK(f.recording.pose_estimated);
  CHECK_FALSE(take_state_as_measured(f.recording));
  Fixture with_dvl;
  with_dvl.recording.dvl.push_back({.utime = 1'000'000});
  CHECK(take_state_as_measured(with_dvl.recording));
  CHECK_FALSE(with_dvl.recording.one_estimate);
  Recording nothing;
  CHECK_FALSE(take_state_as_measured(nothing));
}
