// What a set of trials offers: signals, ranges, sizes.
#include <algorithm>
#include <cmath>

#include "common/model/open_scene.hpp"
#include "common/model/rollout.hpp"
#include "common/model/tones.hpp"

namespace fathom::model {
namespace {

constexpr std::size_t kMostTones = 6;

}  // namespace

Scene open_scene(const Vehicle& vehicle, bool wrench) {
  Scene scene{.vehicle = &vehicle, .position = true, .attitude = true, .velocity = true, .rates = true};
  scene.input_is_wrench = wrench;
  scene.voltage = true;
  scene.mean_voltage = vehicle.nominal_voltage > 0.0 ? vehicle.nominal_voltage : 1.0;
  scene.voltage_range = 1.0;
  scene.duration = scene.t_high = 3600.0;  // s
  scene.nu_rms.setOnes();
  scene.tau_rms.setOnes();
  scene.force_rms = ActuatorForces::Ones(wrench ? 6 : vehicle.allocation.cols());
  scene.p_low.setConstant(-1.0);
  scene.p_high.setOnes();
  return scene;
}

Scene scene_of(const Vehicle& vehicle, std::span<const Trial> trials) {
  Scene scene{.vehicle = &vehicle};
  scene.runs = std::max(static_cast<int>(trials.size()), 1);
  double count = 0.0;
  double voltage_sum = 0.0, voltage_count = 0.0, voltage_low = 1e9, voltage_high = -1e9;
  double tilt_square = 0.0, tilt_count = 0.0;
  const Trial* longest = nullptr;
  bool first = true, timed = false;
  const Model nominal = nominal_model(vehicle, !trials.empty() && trials[0].input_is_wrench);
  scene.force_rms = ActuatorForces::Zero(nominal.allocation.cols());
  for (const Trial& trial : trials) {
    scene.position = scene.position || trial.observed.position;
    scene.attitude = scene.attitude || trial.observed.attitude;
    scene.velocity = scene.velocity || trial.observed.velocity;
    scene.rates = scene.rates || trial.observed.rates;
    scene.input_is_wrench = scene.input_is_wrench || trial.input_is_wrench;
    if (trial.size() > 0) {
      const double span = trial.t.back() - trial.t.front();
      if (longest == nullptr || span > scene.duration) longest = &trial;
      scene.duration = std::max(scene.duration, span);
      scene.t_low = timed ? std::min(scene.t_low, trial.t.front()) : trial.t.front();
      scene.t_high = timed ? std::max(scene.t_high, trial.t.back()) : trial.t.back();
      timed = true;
    }
    for (std::size_t k = 0; k < trial.size(); ++k) {
      scene.p_low = first ? trial.p_WB[k] : scene.p_low.cwiseMin(trial.p_WB[k]).eval();
      scene.p_high = first ? trial.p_WB[k] : scene.p_high.cwiseMax(trial.p_WB[k]).eval();
      first = false;
      scene.nu_rms += trial.nu[k].cwiseAbs2();
      scene.tau_rms += (nominal.allocation * trial.input[k]).cwiseAbs2();
      scene.force_rms += trial.input[k].cwiseAbs2();
      if (trial.observed.attitude) {
        const Eigen::Vector3d down_B = trial.q_WB[k].conjugate() * Eigen::Vector3d::UnitZ();
        tilt_square += down_B.head<2>().squaredNorm();
        tilt_count += 1.0;
      }
      count += 1.0;
    }
    for (const double voltage : trial.voltage) {
      voltage_sum += voltage;
      voltage_count += 1.0;
      voltage_low = std::min(voltage_low, voltage);
      voltage_high = std::max(voltage_high, voltage);
    }
  }
  if (count > 0.0) {
    scene.nu_rms = (scene.nu_rms / count).cwiseSqrt().eval();
    scene.tau_rms = (scene.tau_rms / count).cwiseSqrt().eval();
    scene.force_rms = (scene.force_rms / count).cwiseSqrt().eval();
  }
  if (tilt_count > 0.0) scene.tilt_rms = std::sqrt(tilt_square / tilt_count);
  if (longest != nullptr) {
    const Tones tones = strongest_tones(vehicle, *longest, kMostTones);
    scene.tones_horizontal = tones.horizontal;
    scene.tones_vertical = tones.vertical;
  }
  scene.voltage = voltage_count > 0.0;
  if (scene.voltage) {
    scene.mean_voltage = voltage_sum / voltage_count;
    scene.voltage_range = voltage_high - voltage_low;
  }
  return scene;
}

}  // namespace fathom::model
