// A virtual dive flown once more with what a likelihood must tell apart: a random force with a memory, a white one, and
// sensors whose noise is white and coloured, constant or not.
#pragma once

#include <cmath>
#include <functional>
#include <random>

#include "common/model/rollout.hpp"
#include "test/support/virtual_dive.hpp"

namespace fathom::test {

struct NoisyDive {
  double duration{100.0}, dt{0.02};  // s
  unsigned seed{1};
  double force{0.0}, force_memory{0.8};  // m/s^2 and rad/s^2, s
  double white_force{0.0};               // m/s^2/sqrt(Hz)
  double sensor{0.002};                  // m/s, rad/s
  double colour{0.0}, colour_memory{0.1};
  std::vector<model::ActiveEffect> effects{};
  std::function<double(double t, std::mt19937&)> sensor_factor{};   // of each sensor number, where noise varies
  std::function<Vector6d(double t, const Vector6d& nu)> outside{};  // acceleration that no model holds
  std::function<double(double t)> voltage{};                        // V; none: no battery
};

inline VirtualDive fly(const model::Vehicle& vehicle, const NoisyDive& settings) {
  DiveSettings dive_settings{
      .duration = settings.duration, .dt = settings.dt, .step = settings.dt, .seed = settings.seed};
  dive_settings.effects = settings.effects;
  VirtualDive dive = make_dive(vehicle, dive_settings);
  Trial& trial = dive.trial;
  const model::InputSignal input = model::input_of(dive.truth, trial);
  std::mt19937 random{settings.seed + 1000};
  std::normal_distribution<double> normal;
  const auto gauss = [&] {
    Vector6d x;
    for (int i = 0; i < 6; ++i) x[i] = normal(random);
    return x;
  };
  const int substeps = std::max(1, static_cast<int>(std::lround(settings.dt / 0.005)));
  const double h = settings.dt / substeps;
  const double keep = std::exp(-h / settings.force_memory), fresh = settings.force * std::sqrt(1.0 - keep * keep);
  const double keep_colour = std::exp(-settings.dt / settings.colour_memory);
  Vector6d nu = Vector6d::Zero(), d = settings.force * gauss(), colour = settings.colour * gauss();
  Eigen::Vector3d p = Eigen::Vector3d::Zero();
  Eigen::Quaterniond q = Eigen::Quaterniond::Identity();
  std::vector<double> memory(static_cast<std::size_t>(dive.truth.memory_size()), 0.0);
  for (std::size_t k = 0; k < trial.size(); ++k) {
    if (settings.voltage) trial.voltage[k] = settings.voltage(trial.t[k]);
    trial.p_WB[k] = p;
    trial.q_WB[k] = q;
    Vector6d noise = settings.sensor * gauss();
    if (settings.sensor_factor) {
      for (int i = 0; i < 6; ++i) noise[i] *= settings.sensor_factor(trial.t[k], random);
    }
    if (k > 0) colour = keep_colour * colour + settings.colour * std::sqrt(1.0 - keep_colour * keep_colour) * gauss();
    trial.nu[k] = nu + noise + colour;
    for (int s = 0; s < substeps; ++s) {
      const double t = trial.t[k] + (s + 0.5) * h;
      d = keep * d + fresh * gauss();
      const auto rate = [&](const Vector6d& at, bool advance) {
        model::Motion motion;
        motion.t = t;
        motion.p_WB = p;
        motion.R_WB = q.toRotationMatrix();
        motion.nu = at;
        motion.vehicle = &vehicle;
        if (settings.voltage) motion.voltage = settings.voltage(t);
        motion.input = &input;
        input.now(t, motion.force);
        model::feel(dive.truth, motion, memory, advance ? h : 0.0);
        Vector6d outside = d;
        if (settings.outside) outside += settings.outside(t, at);
        for (int i = 0; i < 6; ++i) outside[i] *= vehicle.dof[static_cast<std::size_t>(i)] ? 1.0 : 0.0;
        return Vector6d{model::acceleration(dive.truth, motion) + outside};
      };
      const Vector6d middle = nu + 0.5 * h * rate(nu, true);
      const Eigen::Quaterniond q_middle = q * quaternion_from_rotation_vector(0.5 * h * middle.tail<3>());
      nu += h * rate(middle, false);
      const Vector6d white = settings.white_force * std::sqrt(h) * gauss();
      for (int i = 0; i < 6; ++i) nu[i] += vehicle.dof[static_cast<std::size_t>(i)] ? white[i] : 0.0;
      p += h * (q_middle * middle.head<3>());
      q = (q * quaternion_from_rotation_vector(h * middle.tail<3>())).normalized();
    }
  }
  trial.nu_sigma.setConstant(settings.sensor);
  return dive;
}

}  // namespace fathom::test
