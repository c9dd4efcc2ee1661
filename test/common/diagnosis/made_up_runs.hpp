// Runs whose residual is noise and a structure that is put in, for tests of what a residual goes with.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "common/diagnosis/associations.hpp"
#include "common/diagnosis/moved.hpp"
#include "common/residual/force_residual.hpp"

namespace fathom::diagnosis {

constexpr double kDt = 0.05;          // s
constexpr std::size_t kCount = 6600;  // samples
constexpr double kShare = 0.1, kOdds = 5.0;
constexpr double kTumbleDt = 0.2;           // s
constexpr std::size_t kTumbleSamples = 60;  // that do not overlap

inline model::Vehicle one_axis() {
  model::Vehicle vehicle;
  vehicle.dof[0] = true;
  return vehicle;
}

/// A craft of 10 kg that surges, turning slowly; `memory`: of the noise, s; `answer`: of a pilot to its speed,
/// N/(m/s); `effort`: what is wanted of the thrusters, N (RMS). What the model lacks is noise of 1 N, and the
/// structure.
struct Dive {
  model::Vehicle vehicle = one_axis();
  model::Model model = model::nominal_model(vehicle, true);
  std::vector<Trial> trials{1};
  std::vector<std::vector<Vector6d>> residuals{1};

  using Structure = std::function<double(const Trial&, std::size_t)>;
  explicit Dive(unsigned seed, double memory = 0.0, double answer = 0.0, const Structure& structure = {},
                double effort = 20.0, std::size_t count = kCount) {
    model.theta[model::index(*model::parameter_from_name("m_X"))] = 10.0;
    model.theta[model::index(*model::parameter_from_name("X_u"))] = -8.0;
    std::mt19937 random{seed};
    std::normal_distribution<double> normal;
    Trial& trial = trials[0];
    trial.name = "dive";
    trial.dt = kDt;
    trial.observed = {true, true, true, true};
    const double keep = memory > 0.0 ? std::exp(-kDt / memory) : 0.0;
    double noise = 0.0, u = 0.0, x = 0.0, wanted = 0.0;
    std::vector<double> sum{0.0};  // of what the model lacks
    for (std::size_t k = 0; k < count; ++k) {
      const double t = kDt * static_cast<double>(k);
      if (k % 80 == 0) wanted = effort * normal(random);
      noise = keep * noise + std::sqrt(1.0 - keep * keep) * normal(random);
      trial.t.push_back(t);
      trial.p_WB.emplace_back(x, std::sin(0.11 * t), 2.0 + 0.5 * std::sin(0.07 * t));
      trial.q_WB.emplace_back(Eigen::AngleAxisd(0.05 * t + std::sin(0.2 * t), Eigen::Vector3d::UnitZ()));
      trial.nu.emplace_back(u * Vector6d::Unit(0));
      trial.pose_valid.push_back(1);
      trial.velocity_valid.push_back(1);
      trial.rates_valid.push_back(1);
      trial.input.emplace_back(Eigen::VectorXd::Unit(6, 0) * (wanted - answer * u - 0.5 * x));
      const double lacking = noise + (structure ? structure(trial, k) : 0.0);
      sum.push_back(sum.back() + lacking);
      u += kDt / 10.0 * (trial.input.back()[0] - 8.0 * u + lacking);
      x += kDt * u;
    }
    const std::size_t span = residual_span(kDt), half = span / 2;  // a residual is a mean
    residuals[0].assign(count, Vector6d::Constant(std::numeric_limits<double>::quiet_NaN()));
    for (std::size_t k = half; k + half < count; ++k)
      residuals[0][k] = (sum[k + half + 1] - sum[k - half]) / static_cast<double>(span) * Vector6d::Unit(0);
  }
  [[nodiscard]] std::vector<Association> left(double of_wrench = 0.0) const {
    return LeftOver{model, trials, residuals}.associations(kShare, kOdds, of_wrench);
  }
};

/// A craft that moves along and about all axes for as short a time as lets a thrust be asked, beside noise without a
/// memory.
struct Tumble {
  model::Vehicle vehicle;
  model::Model model;
  std::vector<Trial> trials{1};
  std::vector<std::vector<Vector6d>> residuals{1};

  explicit Tumble(unsigned seed, std::size_t samples = kTumbleSamples) {
    vehicle.dof.fill(true);
    model = model::nominal_model(vehicle, true);
    constexpr double kMemory = 2.0;  // s, of its speeds
    const double keep = std::exp(-kTumbleDt / kMemory);
    const std::size_t span = residual_span(kTumbleDt);
    const std::size_t count = samples * span;
    std::mt19937 random{seed};
    std::normal_distribution<double> normal;
    const auto drawn = [&] { return Vector6d{Vector6d::NullaryExpr([&] { return normal(random); })}; };
    Trial& trial = trials[0];
    trial.name = "tumble";
    trial.dt = kTumbleDt;
    trial.observed = {true, true, true, true};
    Vector6d nu = drawn(), tau = drawn();
    for (std::size_t k = 0; k < count; ++k) {
      const double t = kTumbleDt * static_cast<double>(k);
      if (k % 10 == 0) tau = drawn();
      nu = keep * nu + std::sqrt(1.0 - keep * keep) * drawn();
      trial.t.push_back(t);
      trial.p_WB.emplace_back(std::sin(0.3 * t), std::sin(0.11 * t), 2.0 + 0.5 * std::sin(0.2 * t));
      trial.q_WB.emplace_back(Eigen::AngleAxisd(0.2 * t, Eigen::Vector3d::UnitZ()));
      trial.nu.push_back(nu);
      trial.pose_valid.push_back(1);
      trial.velocity_valid.push_back(1);
      trial.rates_valid.push_back(1);
      trial.input.emplace_back(tau);
      if (k % span == 0) residuals[0].resize(k + span, drawn());  // a residual is a mean
    }
    residuals[0].resize(count);
  }
  [[nodiscard]] std::vector<Association> left() const {
    return LeftOver{model, trials, residuals}.associations(kShare, kOdds, 0.0);
  }
};

inline double heading(const Trial& trial, std::size_t k) {
  return euler_from_rotation(trial.q_WB[k].toRotationMatrix()).z();
}

/// Three seconds in about fifteen, at moments without a period.
inline bool episode(double t) {
  const double n = std::floor(t / 15.0);
  const double begin = 15.0 * n + 12.0 * (0.5 + 0.5 * std::sin(2.4 * n * n));
  return t >= begin && t < begin + 3.0;
}

inline bool among(const std::vector<Association>& left, const std::string& with) {
  return std::ranges::any_of(left, [&](const Association& a) { return a.with.starts_with(with); });
}

}  // namespace fathom::diagnosis
