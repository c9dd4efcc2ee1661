// A four-axis vehicle with the numbers of Karras et al., Table 1.1, integrated by formulas of its own (written out per
// axis, not taken from the code under test): truth for the tests of this folder.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cmath>
#include <random>
#include <string>
#include <vector>

namespace fathom::test {

struct Truth {
  double t{};
  Eigen::Vector4d nu{Eigen::Vector4d::Zero()};   // u v w r
  Eigen::Vector4d dot{Eigen::Vector4d::Zero()};  // and its derivative
  Eigen::Vector4d tau{Eigen::Vector4d::Zero()};  // X Y Z N
  double yaw{};
};

/// m_X m_Y m_Z I_Z | X_u Y_v Z_w N_r | X_u|u| Y_v|v| Z_w|w| N_r|r| | W-B
constexpr std::array<double, 13> kTable{9.7532,  8.6636,   10.898,  0.1589,  -8.6040,  -18.1106, -17.1828,
                                        -1.4146, -17.8534, -1.0594, -3.6482, -10.3483, -1.1881};
inline const std::array<std::string, 13> kTableNames{"m_X", "m_Y",    "m_Z",    "I_Z",    "X_u",    "Y_v", "Z_w",
                                                     "N_r", "X_u|u|", "Y_v|v|", "Z_w|w|", "N_r|r|", "W-B"};

/// Level vehicle, random sums of sines on every axis. `dt` between samples; ten integration steps in each.
inline std::vector<Truth> karras_run(double duration, double dt, unsigned seed) {
  std::mt19937 engine{seed};
  std::uniform_real_distribution<double> any{0.0, 1.0};
  constexpr int kSines = 8;
  struct Sine {
    double amplitude, rate, phase;
  };
  std::array<std::array<Sine, kSines>, 4> input{};
  constexpr std::array<double, 4> kStrength{12.0, 12.0, 10.0, 1.2};
  for (std::size_t axis = 0; axis < 4; ++axis) {
    for (Sine& s : input[axis]) {
      s = {kStrength[axis] * (0.3 + 0.7 * any(engine)) / std::sqrt(kSines / 2.0),
           6.283185307179586 * (0.02 + 0.38 * any(engine)), 6.283185307179586 * any(engine)};
    }
  }
  const auto tau = [&](double t) {
    Eigen::Vector4d f;
    for (int axis = 0; axis < 4; ++axis) {
      f(axis) = axis == 2 ? kTable[12] * -1.0 : 0.0;  // trim
      for (const Sine& s : input[static_cast<std::size_t>(axis)])
        f(axis) += s.amplitude * std::sin(s.rate * t + s.phase);
    }
    return f;
  };
  const auto derivative = [&](double t, const Eigen::Vector4d& x) {
    const Eigen::Vector4d f = tau(t);
    const double u = x(0), v = x(1), w = x(2), r = x(3);
    const auto& k = kTable;
    return Eigen::Vector4d{(f(0) + v * r * k[1] + u * k[4] + u * std::abs(u) * k[8]) / k[0],
                           (f(1) - u * r * k[0] + v * k[5] + v * std::abs(v) * k[9]) / k[1],
                           (f(2) + w * k[6] + w * std::abs(w) * k[10] + k[12]) / k[2],
                           (f(3) + u * v * (k[0] - k[1]) + r * k[7] + r * std::abs(r) * k[11]) / k[3]};
  };
  std::vector<Truth> run;
  Truth now;
  const int samples = static_cast<int>(std::lround(duration / dt));
  for (int i = 0; i <= samples; ++i) {
    now.t = i * dt;
    now.tau = tau(now.t);
    now.dot = derivative(now.t, now.nu);
    run.push_back(now);
    constexpr int kSteps = 10;
    const double h = dt / kSteps;
    for (int j = 0; j < kSteps; ++j) {
      const double t = now.t + j * h;
      const Eigen::Vector4d a = derivative(t, now.nu);
      const Eigen::Vector4d b = derivative(t + h / 2, now.nu + h / 2 * a);
      const Eigen::Vector4d c = derivative(t + h / 2, now.nu + h / 2 * b);
      const Eigen::Vector4d d = derivative(t + h, now.nu + h * c);
      now.nu += h / 6 * (a + 2 * b + 2 * c + d);
      now.yaw += h * now.nu(3);
    }
  }
  return run;
}

}  // namespace fathom::test
