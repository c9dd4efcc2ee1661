// What each instrument says against numbers worked out by hand and against its settings, over many seeds.
#include <doctest/doctest.h>

#include <cmath>
#include <map>
#include <string>

#include "common/base/error.hpp"
#include "test/support/sensor_bench.hpp"
#include "test/support/timing.hpp"

using namespace fathom;
using namespace fathom::simulation;
using test::Bench;
using test::check_mean;
using test::check_sigma;
using test::four_sigma;
using test::kExact;
using test::moment_at;
using test::Moments;

namespace {

const std::string kPerfectAhrs =
    "gyro_noise: 0 rad/s\ngyro_bias: 0 rad/s\ngyro_bias_walk: 0 rad/s\nforce_noise: 0 m/s^2\nforce_bias: 0 m/s^2\n"
    "gyro_scale: 0 %\nforce_scale: 0 %\nmisalignment: 0 rad\ntilt_noise: 0 rad\ntilt_wander: 0 rad\n"
    "heading_noise: 0 rad\nheading_wander: 0 rad\nwander_time: 1 s\nheading: true\n";

}  // namespace

TEST_CASE("ahrs: at rest and level the accelerometer reads 0 0 -g; nose up it reads g ahead") {
  Bench bench{make_ahrs, kPerfectAhrs, "tank"};
  Eigen::Vector3d f = std::get<Ahrs>(bench.measure(moment_at({0, 0, 0.5})).front()).f_B;
  CHECK((f - Eigen::Vector3d{0.0, 0.0, -9.81}).norm() < kExact);
  f = std::get<Ahrs>(bench.measure(moment_at({0, 0, 0.5}, {0.0, 0.5 * 3.14159265358979, 0.0})).front()).f_B;
  CHECK((f - Eigen::Vector3d{9.81, 0.0, 0.0}).norm() < 1e-6);
}

TEST_CASE("ahrs: specific force at its own place, by hand") {
  Bench bench{make_ahrs, kPerfectAhrs, "tank", 1, [](model::Vehicle& vehicle) {
                vehicle.mounts.ahrs->p_BS = {0.3, 0.0, 0.0};
              }};
  Vector6d nu = Vector6d::Zero(), nu_dot = Vector6d::Zero();
  nu[0] = 0.5;      // ahead
  nu[5] = 1.0;      // turning to starboard: w x v = 0.5 to starboard, centripetal 0.3 backward
  nu_dot[5] = 2.0;  // and faster: 0.6 to starboard at the arm's end
  nu_dot[0] = 0.1;
  const auto sample =
      std::get<Ahrs>(bench.measure(moment_at({0, 0, 0.5}, Eigen::Vector3d::Zero(), nu, nu_dot)).front());
  CHECK((sample.f_B - Eigen::Vector3d{0.1 - 0.3, 0.5 + 0.6, -9.81}).norm() < kExact);
  CHECK((sample.w_WB_B - Eigen::Vector3d{0.0, 0.0, 1.0}).norm() < kExact);
}

TEST_CASE("single accelerometers and gyros: three of each at the package's place say what it says, along their axes") {
  const auto arm = Eigen::Vector3d{0.3, -0.2, 0.1};
  const Eigen::Matrix3d axes = rotation_from_euler({0.4, -0.7, 1.9});
  const auto change = [&](model::Vehicle& vehicle) {
    vehicle.mounts.ahrs->p_BS = arm;
    for (int i = 0; i < 3; ++i) {
      const std::string name{static_cast<char>('a' + i)};
      vehicle.mounts.singles.push_back({model::SingleInertialMount::Measures::kForce, name, arm, axes.col(i)});
      vehicle.mounts.singles.push_back({model::SingleInertialMount::Measures::kRate, name + "'", {}, axes.col(i)});
    }
  };
  Vector6d nu, nu_dot;
  nu << 0.5, -0.3, 0.2, 0.4, -0.6, 1.0;
  nu_dot << 0.1, 0.2, -0.3, 2.0, -1.0, 1.5;
  const Moment moment = moment_at({0, 0, 0.5}, {0.2, -0.4, 1.1}, nu, nu_dot);
  Bench package{make_ahrs, kPerfectAhrs, "tank", 1, change};
  Bench forces{make_accelerometers, "noise: 0 m/s^2\nbias: 0 m/s^2\n", "tank", 1, change};
  Bench rates{make_gyros, "noise: 0 rad/s\nbias: 0 rad/s\n", "tank", 1, change};
  const auto told = std::get<Ahrs>(package.measure(moment).front());
  const Eigen::Vector3d f = axes.transpose() * told.f_B, w = axes.transpose() * told.w_WB_B;
  REQUIRE(forces.measure(moment).size() == 3);
  REQUIRE(rates.measure(moment).size() == 3);
  for (int i = 0; i < 3; ++i) {
    const auto k = static_cast<std::size_t>(i);
    const auto &force = std::get<Signal>(forces.samples[k]), &rate = std::get<Signal>(rates.samples[k]);
    CHECK(force.name + "'" == rate.name);
    CHECK(force.unit == "m/s^2");
    CHECK(rate.unit == "rad/s");
    CHECK(std::abs(force.value - f[i]) < kExact);
    CHECK(std::abs(rate.value - w[i]) < kExact);
  }
}

TEST_CASE("single accelerometers: noise, and a bias of each, are as stated; a vehicle without them has none") {
  Moments noise, bias;
  const auto one = [](model::Vehicle& vehicle) {
    vehicle.mounts.singles.push_back(
        {model::SingleInertialMount::Measures::kForce, "bow", {1.0, 0.0, 0.0}, Eigen::Vector3d::UnitZ()});
  };
  for (unsigned seed = 1; seed <= test::seeds(120); ++seed) {
    Bench bench{make_accelerometers, "noise: 0.02 m/s^2\nbias: 0.1 m/s^2\n", "tank", seed, one};
    const double drawn = bench.sensor->drawn().front().second;
    bias.add(drawn);
    for (int i = 0; i < 20; ++i)
      noise.add(std::get<Signal>(bench.measure(moment_at({0, 0, 0.5})).front()).value + 9.81 - drawn);
  }
  check_sigma(noise, 0.02);
  check_mean(noise, 0.0, 0.02);
  check_sigma(bias, 0.1);
  CHECK_THROWS_AS((Bench{make_accelerometers, "noise: 0 m/s^2\nbias: 0 m/s^2\n", "tank"}), InputError);
}

TEST_CASE("ahrs: magnetic heading differs by the site's declination") {
  std::string text = kPerfectAhrs;
  text.replace(text.find("heading: true"), 13, "heading: magnetic");
  Bench bench{make_ahrs, text, "deep"};
  const auto sample = std::get<Ahrs>(bench.measure(moment_at({0, 0, 5}, {0.0, 0.0, 1.0})).front());
  const double heading = euler_from_rotation(sample.q_WB.toRotationMatrix()).z();
  CHECK(std::abs(heading - (1.0 - 4.2 * 3.14159265358979 / 180.0)) < kExact);
}

TEST_CASE("ahrs: noise, bias and wander are as stated") {
  Moments gyro, force, bias, tilt;
  const Moment moment = moment_at({0, 0, 0.5});
  for (unsigned seed = 1; seed <= test::seeds(120); ++seed) {
    Bench bench{make_ahrs,
                "gyro_noise: 0.01 rad/s\ngyro_bias: 0.1 rad/s\ngyro_bias_walk: 0 rad/s\nforce_noise: 0.02 m/s^2\n"
                "force_bias: 0 m/s^2\ngyro_scale: 0 %\nforce_scale: 0 %\nmisalignment: 0 rad\ntilt_noise: 0.003 rad\n"
                "tilt_wander: 0.004 rad\nheading_noise: 0 rad\nheading_wander: 0 rad\nwander_time: 0.01 s\n"
                "heading: true\n",
                "tank", seed};
    const double drawn = bench.sensor->drawn().front().second;
    bias.add(drawn);
    for (int i = 0; i < 50; ++i) {
      const auto sample = std::get<Ahrs>(bench.measure(moment).front());
      gyro.add(sample.w_WB_B.x() - drawn);
      force.add(sample.f_B.z() + 9.81);
      tilt.add(rotation_vector_from_quaternion(sample.q_WB).x());
    }
  }
  check_sigma(gyro, 0.01);
  check_mean(gyro, 0.0, 0.01);
  check_sigma(force, 0.02);
  check_sigma(bias, 0.1);
  // Wander of 4 mrad that forgets within a sample, and 3 mrad of noise: 5 mrad. Its samples hang together a little.
  CHECK(tilt.sigma() == doctest::Approx(0.005).epsilon(2.0 * four_sigma(tilt.n)));
}

TEST_CASE("ahrs: each axis of gyro and accelerometer has a scale of its own, along the instrument's axes") {
  std::string text = kPerfectAhrs;
  text.replace(text.find("gyro_scale: 0 %"), 15, "gyro_scale: 1 %");
  text.replace(text.find("force_scale: 0 %"), 16, "force_scale: 2 %");
  Moments gyro, force;
  for (unsigned seed = 1; seed <= test::seeds(120); ++seed) {
    // Mounted a quarter turn to starboard: its x axis is the body's y axis, its y axis the body's -x axis.
    Bench bench{make_ahrs, text, "tank", seed, [](model::Vehicle& vehicle) {
                  vehicle.mounts.ahrs->R_BS << 0.0, -1.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0;
                  vehicle.mounts.ahrs->p_BS.setZero();
                }};
    std::map<std::string, double> drawn;
    for (const auto& [name, value] : bench.sensor->drawn()) drawn[name] = value;
    Vector6d nu = Vector6d::Zero();
    nu.tail<3>() << 0.1, 0.2, 0.3;
    const auto sample = std::get<Ahrs>(bench.measure(moment_at({0, 0, 0.5}, {0.0, 0.0, 0.0}, nu)).front());
    CHECK(std::abs(sample.w_WB_B.x() - 0.1 * (1.0 + drawn["gyro_scale_y"])) < kExact);
    CHECK(std::abs(sample.w_WB_B.y() - 0.2 * (1.0 + drawn["gyro_scale_x"])) < kExact);
    CHECK(std::abs(sample.w_WB_B.z() - 0.3 * (1.0 + drawn["gyro_scale_z"])) < kExact);
    CHECK(std::abs(sample.f_B.z() + 9.81 * (1.0 + drawn["force_scale_z"])) < kExact);
    for (const char* axis : {"x", "y", "z"}) {
      gyro.add(drawn[std::string{"gyro_scale_"} + axis]);
      force.add(drawn[std::string{"force_scale_"} + axis]);
    }
  }
  check_sigma(gyro, 0.01);
  check_sigma(force, 0.02);
}

TEST_CASE("depth: the port's depth less its lever arm, tilted or not; noise and offset as stated") {
  Bench exact{make_depth, "noise: 0 m\noffset: 0 m\nresolution: 0 m\n", "tank"};
  CHECK(std::abs(std::get<Depth>(exact.measure(moment_at({0, 0, 0.7}, {0.2, -0.3, 1.0})).front()).z - 0.7) < kExact);
  Moments all, within;
  for (unsigned seed = 1; seed <= test::seeds(300); ++seed) {
    Bench bench{make_depth, "noise: 4 mm\noffset: 10 mm\nresolution: 0 m\n", "tank", seed};
    const double offset = bench.sensor->drawn().front().second;
    all.add(offset);
    for (int i = 0; i < 20; ++i) {
      within.add(std::get<Depth>(bench.measure(moment_at({0, 0, 0.7})).front()).z - 0.7 - offset);
    }
  }
  check_sigma(all, 0.010);
  check_sigma(within, 0.004);
  check_mean(within, 0.0, 0.004);
}

TEST_CASE("dvl: the velocity of Bo in B whatever its mounting, and the altitude of the instrument") {
  Bench bench{make_dvl,
              "beam_noise: 0 m/s\nscale_error: 0\nbias: 0 m/s\nbeam_loss: 0\nnearest: 0.3 m\nfarthest: 80 m\n", "deep"};
  Vector6d nu;
  nu << 0.4, -0.2, 0.1, 0.05, -0.04, 0.6;
  const auto sample = std::get<Dvl>(bench.measure(moment_at({0, 0, 30}, Eigen::Vector3d::Zero(), nu)).front());
  CHECK(sample.valid);
  CHECK((sample.v_WB_B - nu.head<3>()).norm() < kExact);
  CHECK(std::abs(sample.altitude - (60.0 - 30.14)) < 1e-6);
  CHECK_FALSE(std::get<Dvl>(bench.measure(moment_at({0, 0, 59.7})).front()).valid);  // too near
}

TEST_CASE("dvl: noise follows from the beams' and their angle; lost beams are survived until two are gone") {
  // Four beams at 30 degrees: along x two beams with slope sin 30 each see it, sigma / (sqrt(2) sin 30).
  Moments x, z, scale;
  std::size_t valid = 0, count = 0;
  for (unsigned seed = 1; seed <= test::seeds(200); ++seed) {
    Bench bench{make_dvl,
                "beam_noise: 10 mm/s\nscale_error: 1 %\nbias: 0 m/s\nbeam_loss: 0\nnearest: 0.3 m\nfarthest: 80 m\n",
                "deep", seed};
    scale.add(bench.sensor->drawn().front().second);
    Bench lossy{make_dvl,
                "beam_noise: 0 m/s\nscale_error: 0\nbias: 0 m/s\nbeam_loss: 20 %\nnearest: 0.3 m\nfarthest: 80 m\n",
                "deep", seed};
    for (int i = 0; i < 30; ++i) {
      const Eigen::Vector3d v = std::get<Dvl>(bench.measure(moment_at({0, 0, 30})).front()).v_WB_B;
      x.add(v.x());
      z.add(v.z());
      valid += std::get<Dvl>(lossy.measure(moment_at({0, 0, 30})).front()).valid ? 1 : 0;
      ++count;
    }
  }
  check_sigma(x, 0.010 / (std::sqrt(2.0) * 0.5));
  check_sigma(z, 0.010 / (2.0 * std::cos(3.14159265358979 / 6.0)));
  check_sigma(scale, 0.01);
  const double wanted = 0.8 * 0.8 * 0.8 * 0.8 + 4.0 * 0.2 * 0.8 * 0.8 * 0.8;  // at most one of four is lost
  const double share = static_cast<double>(valid) / static_cast<double>(count);
  CHECK(std::abs(share - wanted) < 4.0 * std::sqrt(wanted * (1.0 - wanted) / static_cast<double>(count)));
}

TEST_CASE("usbl: range and bearing noise across and along the line of sight, outliers, lever arm") {
  const Eigen::Vector3d p{30.0, 40.0, 2.0};  // 50 m away at the transceiver's depth
  Bench exact{make_usbl,
              "range_noise: 0 m\nbearing_noise: 0 rad\nbearing_offset: 0 rad\noutlier: 0\noutlier_size: 0 m\n"
              "farthest: 100 m\n",
              "deep"};
  const auto still = std::get<Usbl>(exact.measure(moment_at(p, {0.1, -0.2, 0.7})).front());
  CHECK((still.p_WB - p).norm() < kExact);
  CHECK(exact.measure(moment_at({200, 0, 2})).empty());
  Moments along, across;
  std::size_t wild = 0, count = 0;
  for (unsigned seed = 1; seed <= test::seeds(200); ++seed) {
    const std::string text = "range_noise: 0.1 m\nbearing_noise: 0.01 rad\nbearing_offset: 0 rad\nfarthest: 100 m\n";
    Bench bench{make_usbl, text + "outlier: 0\noutlier_size: 0 m\n", "deep", seed};
    Bench stray{make_usbl, text + "outlier: 10 %\noutlier_size: 100 m\n", "deep", seed};
    for (int i = 0; i < 20; ++i) {
      const auto sample = std::get<Usbl>(bench.measure(moment_at(p)).front());
      const Eigen::Vector3d error = sample.p_WB - p;
      along.add(error.x() * 0.6 + error.y() * 0.8);
      across.add(-error.x() * 0.8 + error.y() * 0.6);
      // sigma_x^2 = (0.1 0.6)^2 + (0.5 0.8)^2
      CHECK(sample.sigma.x() == doctest::Approx(std::sqrt(0.0036 + 0.16)).epsilon(0.05));
      wild += (std::get<Usbl>(stray.measure(moment_at(p)).front()).p_WB - p).norm() > 5.0 ? 1 : 0;
      ++count;
    }
  }
  check_sigma(along, 0.1);
  // The responder sits 15 cm above Bo, so bearings act on 50.0 m.
  check_sigma(across, 0.01 * 50.0);
  CHECK(static_cast<double>(wild) / static_cast<double>(count) == doctest::Approx(0.1).epsilon(0.3));
}

TEST_CASE("ranges: to each transponder from the transducer, late echoes only longer") {
  Bench exact{make_ranges, "noise: 0 m\nscale_error: 0\nloss: 0\noutlier: 0\noutlier_size: 0 m\nfarthest: 300 m\n",
              "deep", 1, [](model::Vehicle& vehicle) {
                vehicle.mounts.ranges->p_BS = {0.0, 0.0, -2.0};
              }};
  const auto sample = std::get<Ranges>(exact.measure(moment_at({40.0, 0.0, 30.0})).front());
  REQUIRE(sample.range.size() == 5);
  CHECK(std::abs(sample.range[0] - 30.0) < kExact);  // straight above "north", transducer 2 m above Bo
  CHECK(std::abs(sample.range[2] - std::hypot(80.0, 30.0)) < kExact);
  Bench lossy{make_ranges, "noise: 0 m\nscale_error: 0\nloss: 1\noutlier: 0\noutlier_size: 0 m\nfarthest: 300 m\n",
              "deep"};
  CHECK(std::get<Ranges>(lossy.measure(moment_at({0, 0, 30})).front()).valid == std::vector<std::uint8_t>(5, 0));
  Bench late{make_ranges, "noise: 0 m\nscale_error: 0\nloss: 0\noutlier: 1\noutlier_size: 9 m\nfarthest: 300 m\n",
             "deep", 1, [](model::Vehicle& vehicle) {
               vehicle.mounts.ranges->p_BS = {0.0, 0.0, -2.0};
             }};
  for (int i = 0; i < 50; ++i) {
    const double range = std::get<Ranges>(late.measure(moment_at({40.0, 0.0, 30.0})).front()).range[0];
    CHECK(range >= 30.0);
    CHECK(range <= 39.0);
  }
}

TEST_CASE("loads: the tether's pull along each cell's axis") {
  Bench bench{make_loads, "noise: 0 N\nzero_error: 0 N\n", "tank"};
  Moment moment = moment_at({0, 0, 0.5});
  moment.tether_B = {1.0, -2.0, 3.0};
  CHECK(std::get<Loads>(bench.measure(moment).front()).load == std::vector<double>{1.0, -2.0, 3.0});
}

TEST_CASE("tether: hidden, its pull is what the load cells show") {
  auto simulator =
      test::make_simulator("seabotix_lbv150", "tank",
                           {.hide = {"tether_tension=stiffness:2,slack_length:1,anchor_N:-2,anchor_E:0,anchor_D:0.75"}},
                           {{"noise: 0.05 N, zero_error: 0.02 N", "noise: 0 N, zero_error: 0 N"}});
  const auto loads = test::run<Loads>(*simulator, 0.1);
  CHECK(loads.front().load[0] == doctest::Approx(-2.0).epsilon(1e-3));  // 2 m away, 1 m slack, 2 N/m, straight astern
}

TEST_CASE("drop-outs: their share of time is as stated") {
  // Begins with 1 % per sample at 100 Hz and lasts 0.5 s on average: 1 s of work, then 0.5 s of silence.
  auto simulator = test::make_simulator("seabotix_lbv150", "tank", {.seed = 9},
                                        {{"      latency: 6 ms",
                                          "      latency: 0 ms\n      drop_out: 1 %\n      "
                                          "drop_out_length: 0.5 s"}});
  const double seconds = 400.0;
  const auto ahrs = test::run<Ahrs>(*simulator, seconds);
  const double share = static_cast<double>(ahrs.size()) / (100.0 * seconds);
  CHECK(std::abs(share - 2.0 / 3.0) < 0.06);  // about 270 drop-outs: 4 sigma of their total length
}

TEST_CASE("sensor faults: a hidden latency of the rates reaches the gyro") {
  const test::Changes quiet{
      {"gyro_noise: 0.2", "gyro_noise: 0"},           {"gyro_bias: 0.02", "gyro_bias: 0"},
      {"gyro_bias_walk: 0.001", "gyro_bias_walk: 0"}, {"gyro_scale: 0.1", "gyro_scale: 0"},
      {"misalignment: 0.2", "misalignment: 0"},       {"phase: 5 ms", "phase: 0 ms"}};  // at the times of TRUTH
  auto simulator =
      test::make_simulator("seabotix_lbv150", "deep", {.hide = {"sensor_latency=variant:rates,latency:0.2"}}, quiet);
  std::vector<Ahrs> ahrs;
  std::vector<Truth> truth;
  Vector6d tau = Vector6d::Zero();
  tau[5] = 0.5;
  for (int tick = 0; tick < 200; ++tick) {
    simulator->command({.utime = simulator->now(), .tau = tau, .life = 1.0});
    for (const Sample& sample : simulator->step()) {
      if (const auto* a = std::get_if<Ahrs>(&sample)) ahrs.push_back(*a);
      if (const auto* t = std::get_if<Truth>(&sample)) truth.push_back(*t);
    }
  }
  int compared = 0;
  for (const Truth& t : truth) {
    for (const Ahrs& a : ahrs) {
      if (a.utime != t.utime + 200'000) continue;
      CHECK(std::abs(a.w_WB_B.z() - t.nu[5]) < 1e-5);
      ++compared;
    }
  }
  CHECK(compared > 50);
}

TEST_CASE("thrusters: feedback has a gain per thruster, noise, and the wrench of what it reads") {
  const Thrusters told{.force = {10.0, -10.0, 0.0, 5.0}, .has_tau = true};
  Moment moment = moment_at({0, 0, 0.5});
  moment.told = &told;
  Moments gains, noise;
  for (unsigned seed = 1; seed <= 400; ++seed) {
    Bench bench{make_thrusters, "noise: 0.2 N\ngain_error: 3 %\n", "tank", seed};
    const auto first = std::get<Thrusters>(bench.measure(moment).front());
    const auto second = std::get<Thrusters>(bench.measure(moment).front());
    REQUIRE(first.force.size() == 4);
    CHECK(first.force[2] == 0.0);  // it stands still, and knows it
    gains.add(0.5 * (first.force[0] + second.force[0]) / 10.0 - 1.0);
    noise.add((first.force[1] - second.force[1]) / std::sqrt(2.0));
    Vector6d tau = Vector6d::Zero();
    for (Eigen::Index i = 0; i < 4; ++i)
      tau += bench.vehicle.allocation.col(i) * first.force[static_cast<std::size_t>(i)];
    for (Eigen::Index i = 0; i < 6; ++i) CHECK(std::abs(first.tau[static_cast<std::size_t>(i)] - tau[i]) < kExact);
  }
  check_mean(gains, 0.0, 0.035);
  check_sigma(gains, std::hypot(0.03, 0.02 / std::sqrt(2.0)));
  check_sigma(noise, 0.2);
  Moment before = moment_at({0, 0, 0.5});
  Bench bench{make_thrusters, "noise: 0 N\ngain_error: 0 %\n", "tank"};
  CHECK(bench.measure(before).empty());
}

TEST_CASE("timing: with jitter samples come later by any time up to it; without, as ever") {
  const Config plain = Config::parse("rate: 10 Hz\nlatency: 40 ms\n", "bench.yaml");
  const Config jittery = Config::parse("rate: 10 Hz\nlatency: 40 ms\njitter: 60 ms\n", "bench.yaml");
  Timing steady{plain, "depth", 1}, varies{jittery, "depth", 1};
  Moments late;
  for (int i = 0; i < 2000; ++i) {
    CHECK(steady.latency() == 40'000);
    const Utime latency = varies.latency();
    CHECK(latency >= 40'000);
    CHECK(latency <= 100'000);
    late.add(1e-6 * static_cast<double>(latency));
  }
  check_mean(late, 0.07, 0.06 / std::sqrt(12.0));
}
