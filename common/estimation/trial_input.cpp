#include "common/estimation/trial_input.hpp"

#include <algorithm>

#include "common/base/error.hpp"
#include "common/estimation/thruster_forces.hpp"
#include "common/estimation/timeline.hpp"

namespace fathom::estimation {
namespace {

constexpr double kSameTime = 1e-6;  // s: stamps are whole microseconds

/// Input over time: thruster forces or the wrench, one row per sample of the stream.
struct Input {
  std::vector<double> t;
  std::vector<Eigen::VectorXd> x;
  bool is_wrench{false};
};

Input read_input(const Recording& recording, Utime origin, const ThrusterCorrection& correction,
                 const model::Vehicle& vehicle) {
  Input input;
  for (const Thrusters& one : recording.thrusters) {
    Eigen::VectorXd x;
    bool wrench = false;
    if (!one.force.empty()) {
      x = Eigen::Map<const Eigen::VectorXd>(one.force.data(), static_cast<Eigen::Index>(one.force.size()));
    } else if (correction.use_commands && one.pwm_us.size() == vehicle.thrusters.size()) {
      const double voltage =
          recording.battery.empty() ? reference_voltage(vehicle) : voltage_at(recording.battery, one.utime);
      const std::vector<double> force = forces_of(correction, vehicle, one.pwm_us, voltage);
      x = Eigen::Map<const Eigen::VectorXd>(force.data(), static_cast<Eigen::Index>(force.size()));
    } else if (one.has_tau) {
      x = Eigen::Map<const Eigen::VectorXd>(one.tau.data(), 6);
      wrench = true;
    } else {
      continue;
    }
    const double t = seconds_between(origin, one.utime);
    if (!x.allFinite() || (!input.t.empty() && (t <= input.t.back() || x.size() != input.x.back().size()))) continue;
    input.is_wrench = wrench;
    input.t.push_back(t);
    input.x.push_back(std::move(x));
  }
  if (input.t.empty()) {
    throw InputError(
        recording.name +
        ": no thruster forces, no wrench, and no commands that the vehicle's curve could turn into forces");
  }
  return input;
}

/// Mean over [t - dt/2, t + dt/2) when the stream is faster than the grid, else a straight line between neighbours.
void sample_input(const Input& input, const std::vector<double>& grid, double dt, std::vector<Eigen::VectorXd>& out) {
  const bool average = typical_step(input.t) < 0.75 * dt;
  for (const double t : grid) {
    const auto first = std::lower_bound(input.t.begin(), input.t.end(), average ? t - 0.5 * dt - 1e-6 : t);
    const auto i = static_cast<std::size_t>(first - input.t.begin());
    Eigen::VectorXd sum = Eigen::VectorXd::Zero(input.x.front().size());
    int count = 0;
    for (std::size_t j = i; average && j < input.t.size() && input.t[j] < t + 0.5 * dt - 1e-6; ++j, ++count)
      sum += input.x[j];
    if (count > 0) {
      out.emplace_back(sum / count);
    } else if (i == 0) {
      out.push_back(input.x.front());
    } else if (i == input.t.size()) {
      out.push_back(input.x.back());
    } else {
      const double share = (t - input.t[i - 1]) / (input.t[i] - input.t[i - 1]);
      out.emplace_back((1.0 - share) * input.x[i - 1] + share * input.x[i]);
    }
  }
}

/// Mean over each [t, t + dt) if every input is held until the next one.
void sample_held(const Input& input, const std::vector<double>& grid, double dt, std::vector<Eigen::VectorXd>& out) {
  std::size_t i = 0;  // the input that holds
  for (const double t : grid) {
    const double end = t + dt;
    while (i + 1 < input.t.size() && input.t[i + 1] <= t + kSameTime) ++i;
    Eigen::VectorXd sum = Eigen::VectorXd::Zero(input.x.front().size());
    double from = t;
    for (std::size_t j = i; from < end - kSameTime; ++j) {
      const bool last = j + 1 >= input.t.size() || input.t[j + 1] >= end - kSameTime;
      const double to = last ? end : std::max(from, input.t[j + 1]);
      sum += (to - from) * input.x[j];
      from = to;
    }
    out.emplace_back(sum / dt);
  }
}

}  // namespace

void add_input(const Recording& recording, Utime origin, const ThrusterCorrection& correction,
               const model::Vehicle& vehicle, Trial& trial) {
  const Input input = read_input(recording, origin, correction, vehicle);
  trial.input_is_wrench = input.is_wrench;
  trial.input_step = typical_step(input.t);
  sample_input(input, trial.t, trial.dt, trial.input);
  sample_held(input, trial.t, trial.dt, trial.held);
  for (std::size_t i = 0; i < trial.t.size() && !recording.battery.empty(); ++i) {
    trial.voltage.push_back(voltage_at(recording.battery, utime_after(origin, trial.t[i])));
  }
}

}  // namespace fathom::estimation
