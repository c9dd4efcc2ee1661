// Tags, optical flow and laser as they are simulated without pictures, against numbers worked out by hand.
#include <doctest/doctest.h>

#include <cmath>

#include "test/support/sensor_bench.hpp"
#include "test/support/timing.hpp"

using namespace fathom;
using namespace fathom::simulation;
using test::Bench;
using test::check_sigma;
using test::kExact;
using test::moment_at;
using test::Moments;

TEST_CASE("tags: only those whole in the picture, where they are, from every attitude of the camera") {
  const std::string text =
      "corner_noise: 1e-9\nscale_error: 0\nloss: 0\noutlier: 0\noutlier_size: 0 m\nfarthest: 3 m\n";
  Bench bench{make_tag_pose, text, "tank"};
  const Moment level = moment_at({0.0, 0.0, 0.75});
  const auto& camera = bench.vehicle.mounts.cameras.front();
  // The picture shows 2 x 0.63 m x 320/540 = 0.747 m to the sides and 0.56 m ahead and astern of x = 0.1 m. Tags lie
  // every 0.45 m from the middle on: one row ahead (x = 0.45 m does not fit: 0.35 + 0.075 > 0.28), only the middle one
  // is whole.
  REQUIRE(bench.measure(level).size() == 1);
  CHECK(std::get<TagPose>(bench.samples.front()).tag == 4 * 5 + 2);
  for (const Eigen::Vector3d& euler : {Eigen::Vector3d{0.1, -0.15, 0.4}, Eigen::Vector3d{-0.2, 0.1, 2.0}}) {
    const Moment moment = moment_at({0.3, -0.2, 0.4}, euler);
    CHECK(bench.measure(moment).size() >= 2);
    for (const Sample& sample : bench.samples) {
      const auto& seen = std::get<TagPose>(sample);
      const model::Tag& tag = *bench.site.tag(seen.tag);
      const Eigen::Vector3d p_B = camera.mount.p_BS + camera.mount.R_BS * seen.p_CT;
      CHECK((moment.p_WB + moment.R_WB * p_B - tag.p_WT).norm() < 1e-6);
      CHECK((moment.R_WB * camera.mount.R_BS * seen.q_CT.toRotationMatrix() - tag.R_WT).norm() < 1e-6);
    }
  }
  CHECK(bench.measure(moment_at({0, 0, 0.75}, {2.5, 0.0, 0.0})).empty());  // looks up
  CHECK(bench.measure(moment_at({2.45, 0, 0.75})).empty());                // beyond the poster
}

TEST_CASE("tags: errors follow from the corners' pixels") {
  Moments across, along;
  for (unsigned seed = 1; seed <= test::seeds(300); ++seed) {
    Bench bench{make_tag_pose,
                "corner_noise: 0.5\nscale_error: 0\nloss: 0\noutlier: 0\noutlier_size: 0 m\nfarthest: 3 m\n", "tank",
                seed};
    for (int i = 0; i < 10; ++i) {
      const auto sample = std::get<TagPose>(bench.measure(moment_at({-0.1, 0.0, 0.75})).front());
      across.add(sample.p_CT.x());
      along.add(sample.p_CT.z() - 0.63);
    }
  }
  check_sigma(across, 0.5 * 0.63 * 0.5 / 540.0);
  check_sigma(along, 0.63 * 0.5 / (std::sqrt(2.0) * 540.0 * 0.15 / 0.63));
}

TEST_CASE("optical flow: the scene moves against the camera, over its distance, with the lever arm's speed") {
  Bench bench{make_optical_flow, "noise: 0\nnearest: 0.1 m\nfarthest: 3 m\noutlier: 0\n", "tank"};
  Vector6d nu = Vector6d::Zero();
  nu[0] = 0.3;
  nu[1] = -0.1;
  nu[2] = 0.2;
  nu[5] = 0.5;  // the camera sits 0.10 m ahead of Bo: 0.05 m/s to starboard
  Moment moment = moment_at({0, 0, 0.75}, Eigen::Vector3d::Zero(), nu);
  CHECK(bench.measure(moment).empty());  // one picture is no motion
  const Utime first = moment.utime;
  moment.utime += 10'000;
  const auto sample = std::get<OpticalFlow>(bench.measure(moment).front());
  CHECK(sample.utime == first + 5'000);
  CHECK(sample.interval == doctest::Approx(0.01));
  // Camera x to starboard, y astern; 0.63 m above the floor.
  CHECK(std::abs(sample.flow_C.x() - 0.05 / 0.63) < kExact);
  CHECK(std::abs(sample.flow_C.y() - 0.3 / 0.63) < kExact);
  CHECK(std::abs(sample.flow_C.z() + 0.2 / 0.63) < kExact);  // it sinks, and the picture grows
  CHECK(sample.tells_approach());
}

TEST_CASE("optical flow: a hidden scale of the velocity reaches it") {
  Bench bench{make_optical_flow, "noise: 0\nnearest: 0.1 m\nfarthest: 3 m\noutlier: 0\n", "tank"};
  Vector6d nu = Vector6d::Zero();
  nu[0] = 0.3;
  Moment moment = moment_at({0, 0, 0.75}, Eigen::Vector3d::Zero(), nu);
  moment.nu_seen[0] *= 0.8;
  CHECK(bench.measure(moment).empty());
  moment.utime += 10'000;
  CHECK(std::abs(std::get<OpticalFlow>(bench.measure(moment).front()).flow_C.y() - 0.8 * 0.3 / 0.63) < kExact);
}

TEST_CASE("optical flow: the rotation taken out is that of the picture, whatever the age of the newest rates") {
  Bench bench{make_optical_flow, "noise: 0\nnearest: 0.1 m\nfarthest: 3 m\noutlier: 0\n", "tank"};
  const auto turning = [](double q, Utime after) {
    Vector6d nu = Vector6d::Zero();
    nu[0] = 0.3;
    nu[4] = q;
    Moment moment = moment_at({0, 0, 0.75}, Eigen::Vector3d::Zero(), nu);
    moment.utime += after;
    return moment;
  };
  const auto flow_with = [&](double gyro_error) {
    const auto tell = [&](const Moment& moment) {
      bench.told.hear({.utime = moment.utime,
                       .w_WB_B = moment.nu.tail<3>() + Eigen::Vector3d{0.0, gyro_error, 0.0},
                       .q_WB = moment.q_WB,
                       .has_rates = true},
                      moment);
    };
    bench.samples.clear();
    tell(turning(0.1, -9'000));  // 9 ms ago it turned otherwise
    bench.sensor->measure(turning(0.4, 0), bench.samples);
    tell(turning(0.4, 1'000));
    bench.sensor->measure(turning(0.4, 10'000), bench.samples);
    return std::get<OpticalFlow>(bench.samples.back()).flow_C;
  };
  // Forward over the floor, and the camera's arm of 0.12 m below turns with it.
  const Eigen::Vector3d right = flow_with(0.0);
  CHECK(std::abs(right.y() - (0.3 + 0.4 * 0.12) / 0.63) < kExact);
  CHECK(std::abs(right.x()) < kExact);
  CHECK(std::abs((flow_with(0.02) - right).norm() - 0.02) < kExact);  // the gyro's own error does remain
}

TEST_CASE("laser: the dot on the floor, tilted or not; triangulation's error grows with the square") {
  Bench bench{make_laser_range, "dot_noise: 0\nscale_error: 0\nfarthest: 3 m\noutlier: 0\n", "tank"};
  const auto level = std::get<LaserRange>(bench.measure(moment_at({0, 0, 0.75})).front());
  CHECK((level.p_CL - Eigen::Vector3d{0.06, 0.0, 0.63}).norm() < kExact);
  const Moment tilted = moment_at({0.2, 0.1, 0.6}, {0.1, 0.2, 0.5});
  const auto dot = std::get<LaserRange>(bench.measure(tilted).front());
  const auto& mount = bench.vehicle.mounts.cameras.front().mount;
  CHECK(std::abs((tilted.p_WB + tilted.R_WB * (mount.p_BS + mount.R_BS * dot.p_CL)).z() - 1.5) < kExact);
  Moments z;
  for (unsigned seed = 1; seed <= test::seeds(300); ++seed) {
    Bench noisy{make_laser_range, "dot_noise: 0.3\nscale_error: 0\nfarthest: 3 m\noutlier: 0\n", "tank", seed};
    for (int i = 0; i < 10; ++i) {
      z.add(std::get<LaserRange>(noisy.measure(moment_at({0, 0, 0.75})).front()).p_CL.z() - 0.63);
    }
  }
  check_sigma(z, 0.63 * 0.63 * 0.3 / (540.0 * 0.06));
}
