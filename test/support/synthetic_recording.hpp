// Recordings of a made-up motion that is known at every instant, with seeded noise and the faults that a test asks for.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <functional>
#include <numbers>
#include <random>
#include <string>

#include "common/base/spatial.hpp"
#include "common/samples/recording.hpp"

namespace fathom::test {

struct SyntheticOptions {
  unsigned seed{1};
  double duration{240.0};                                   // s
  double pose_rate{20.0}, gyro_rate{20.0}, dvl_rate{10.0};  // Hz; 0: not recorded
  double position_noise{0.005}, angle_noise{0.0035};        // m, rad (0.2 deg)
  double velocity_noise{0.005}, rate_noise{0.0035};         // m/s, rad/s
  double force_noise{0.05};                                 // m/s^2
  std::array<double, 6> activity{1, 1, 1, 1, 1, 1};         // share of the usual amplitude: x y z roll pitch yaw
  bool accelerometer{false};
  double uneven{0.0};   // share of a step by which steps differ, either way
  double missing{0.0};  // share of the samples that were lost
  // Faults: logged = matrix * true(t - delay) + bias.
  Eigen::Matrix3d gyro_matrix{Eigen::Matrix3d::Identity()}, dvl_matrix{Eigen::Matrix3d::Identity()},
      force_matrix{Eigen::Matrix3d::Identity()};
  Eigen::Vector3d gyro_bias{Eigen::Vector3d::Zero()}, dvl_bias{Eigen::Vector3d::Zero()};
  double gyro_delay{}, dvl_delay{};                    // s
  Eigen::Vector3d dvl_lever{Eigen::Vector3d::Zero()};  // m
  double depth_scale{1.0}, depth_delay{};              // -, s
  std::function<void(PoseCapture&)> spoil_pose{};      // applied last
  std::function<void(Dvl&, double t)> spoil_dvl{};
  std::function<void(Ahrs&, double t)> spoil_gyro{};
};

/// Sums of incommensurate sines: position, roll, pitch, yaw with exact derivatives.
class SyntheticMotion {
 public:
  explicit SyntheticMotion(unsigned seed, const std::array<double, 6>& activity = {1, 1, 1, 1, 1, 1}) {
    std::mt19937 random(seed * 7919u + 13u);
    std::uniform_real_distribution<double> phase(0.0, 2.0 * std::numbers::pi), detune(0.85, 1.15);
    constexpr std::array<double, 6> kAmplitude{0.8, 0.6, 0.3, 0.12, 0.12, 1.5};  // m, rad
    constexpr std::array<double, 4> kFrequency{0.05, 0.11, 0.23, 0.41};          // Hz
    constexpr std::array<double, 4> kShare{1.0, 0.5, 0.25, 0.1};
    for (std::size_t a = 0; a < 6; ++a) {
      for (std::size_t k = 0; k < 4; ++k) {
        terms_[a][k] = {activity[a] * kAmplitude[a] * kShare[k],
                        2.0 * std::numbers::pi * kFrequency[k] * detune(random), phase(random)};
      }
    }
  }
  [[nodiscard]] Eigen::Vector3d p_WB(double t) const { return {at(0, t, 0), at(1, t, 0), at(2, t, 0)}; }
  [[nodiscard]] Eigen::Matrix3d R_WB(double t) const {
    return rotation_from_euler({at(3, t, 0), at(4, t, 0), at(5, t, 0)});
  }
  [[nodiscard]] Eigen::Vector3d v_B(double t) const {
    return R_WB(t).transpose() * Eigen::Vector3d(at(0, t, 1), at(1, t, 1), at(2, t, 1));
  }
  [[nodiscard]] Eigen::Vector3d w_B(double t) const {
    const double roll = at(3, t, 0), pitch = at(4, t, 0), droll = at(3, t, 1), dpitch = at(4, t, 1), dyaw = at(5, t, 1);
    return {droll - std::sin(pitch) * dyaw, std::cos(roll) * dpitch + std::sin(roll) * std::cos(pitch) * dyaw,
            -std::sin(roll) * dpitch + std::cos(roll) * std::cos(pitch) * dyaw};
  }
  [[nodiscard]] Eigen::Vector3d f_B(double t) const {
    return R_WB(t).transpose() * Eigen::Vector3d(at(0, t, 2), at(1, t, 2), at(2, t, 2) - 9.81);
  }

 private:
  struct Term {
    double amplitude, omega, phase;
  };
  [[nodiscard]] double at(std::size_t axis, double t, int derivative) const {
    double sum = 0.0;
    for (const Term& term : terms_[axis]) {
      sum += term.amplitude * std::pow(term.omega, derivative) *
             std::sin(term.omega * t + term.phase + 0.5 * std::numbers::pi * derivative);
    }
    return sum;
  }
  std::array<std::array<Term, 4>, 6> terms_{};
};

inline Recording synthetic_recording(const SyntheticOptions& o, const std::string& name = "synthetic") {
  const SyntheticMotion motion(o.seed, o.activity);
  std::mt19937 random(o.seed);
  std::normal_distribution<double> normal;
  const auto noise = [&](double sigma) {
    return Eigen::Vector3d(sigma * normal(random), sigma * normal(random), sigma * normal(random));
  };
  const auto stamps = [&](double rate, auto use) {
    const int count = rate > 0.0 ? static_cast<int>(o.duration * rate) : 0;
    std::mt19937 chance(o.seed + 101u);
    std::uniform_real_distribution<double> lost(0.0, 1.0), longer(-o.uneven, o.uneven);
    double late = 0.0;  // s behind equal steps
    for (int i = 0; i < count; ++i) {
      if (i > 0) late += longer(chance) / rate;
      if (lost(chance) < o.missing) continue;
      const Utime utime = utime_after(0, 2.0 + i / rate + late);
      use(late == 0.0 ? i / rate : seconds_between(utime_after(0, 2.0), utime), utime);
    }
  };
  Recording recording;
  recording.name = name;
  stamps(o.pose_rate, [&](double t, Utime utime) {
    const Eigen::Quaterniond q(motion.R_WB(t));
    PoseCapture pose{.utime = utime,
                     .p_WB = motion.p_WB(t) + noise(o.position_noise),
                     .q_WB = (q * quaternion_from_rotation_vector(noise(o.angle_noise))).normalized(),
                     .valid = true};
    if (o.spoil_pose) o.spoil_pose(pose);
    recording.pose_capture.push_back(pose);
  });
  stamps(o.gyro_rate, [&](double t, Utime utime) {
    Ahrs ahrs;
    ahrs.utime = utime;
    ahrs.w_WB_B = o.gyro_matrix * (motion.w_B(t - o.gyro_delay) + noise(o.rate_noise)) + o.gyro_bias;
    ahrs.has_rates = true;
    if (o.accelerometer) {
      ahrs.f_B = o.force_matrix * (motion.f_B(t - o.gyro_delay) + noise(o.force_noise));
      ahrs.has_specific_force = true;
    }
    if (o.spoil_gyro) o.spoil_gyro(ahrs, t);
    recording.ahrs.push_back(ahrs);
  });
  stamps(o.dvl_rate, [&](double t, Utime utime) {
    const double s = t - o.dvl_delay;
    Dvl dvl{.utime = utime,
            .v_WB_B = o.dvl_matrix * (motion.v_B(s) + motion.w_B(s).cross(o.dvl_lever) + noise(o.velocity_noise)) +
                      o.dvl_bias,
            .altitude = 0.0,
            .valid = true,
            .held = false};
    if (o.spoil_dvl) o.spoil_dvl(dvl, t);
    recording.dvl.push_back(dvl);
  });
  stamps(10.0, [&](double t, Utime utime) {
    recording.depth.push_back(
        {utime, o.depth_scale * motion.p_WB(t - o.depth_delay).z() + 0.4 + 0.01 * normal(random)});
  });
  stamps(20.0, [&](double, Utime utime) {
    Thrusters thrusters;
    thrusters.utime = utime;
    thrusters.has_tau = true;
    recording.thrusters.push_back(thrusters);
  });
  return recording;
}

}  // namespace fathom::test
