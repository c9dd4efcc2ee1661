#include "common/estimation/trial_input.hpp"

#include <algorithm>

#include "common/base/error.hpp"
#include "common/estimation/thruster_forces.hpp"
#include "common/estimation/timeline.hpp"

namespace fathom::estimation {
namespace {

constexpr double kFaster = 0.75;    // of the grid's step: inputs closer than that are averaged over it
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
    throw InputError(recording.name +
                     ": nothing says what drove the vehicle: no thruster forces (f1 ...), no wrench (X ... N), and no "
                     "commands (pwm1 "
                     "...) that the vehicle file's thrust curve could turn into forces");
  }
  return input;
}

/// Of the inputs in [t - dt/2, t + dt/2); on a straight line between neighbours where there are none.
Eigen::VectorXd mean_around(const Input& input, double t, double dt) {
  const auto first = std::lower_bound(input.t.begin(), input.t.end(), t - 0.5 * dt - kSameTime);
  const auto i = static_cast<std::size_t>(first - input.t.begin());
  Eigen::VectorXd sum = Eigen::VectorXd::Zero(input.x.front().size());
  int count = 0;
  for (std::size_t j = i; j < input.t.size() && input.t[j] < t + 0.5 * dt - kSameTime; ++j, ++count) sum += input.x[j];
  if (count > 0) return sum / count;
  if (i == 0) return input.x.front();
  if (i == input.t.size()) return input.x.back();
  const double share = (t - input.t[i - 1]) / (input.t[i] - input.t[i - 1]);
  return (1.0 - share) * input.x[i - 1] + share * input.x[i];
}

/// Inputs that come faster than the grid are averaged as the velocities are, around each of its times and, for what
/// they do from one to the next, over each step of it (Simpson's rule).
void average(const Input& input, Trial& trial) {
  const double half = 0.5 * trial.dt;
  for (const double t : trial.t) {
    trial.input.push_back(mean_around(input, t, trial.dt));
    trial.held.emplace_back((trial.input.back() + 4.0 * mean_around(input, t + half, trial.dt) +
                             mean_around(input, t + trial.dt, trial.dt)) /
                            6.0);
  }
}

/// Mean over each [t, t + dt) if every input holds until the next one, or `ahead`, from the one before on.
void sample_held(const Input& input, const Trial& trial, bool ahead, std::vector<Eigen::VectorXd>& out) {
  const std::size_t last = input.t.size() - 1;
  std::size_t i = 0;  // of the first row after t
  for (const double t : trial.t) {
    const double end = t + trial.dt;
    while (i <= last && input.t[i] <= t + kSameTime) ++i;
    Eigen::VectorXd sum = Eigen::VectorXd::Zero(input.x.front().size());
    double from = t;
    for (std::size_t j = i; from < end - kSameTime; ++j) {  // between rows j - 1 and j
      const double to = j > last || input.t[j] >= end - kSameTime ? end : input.t[j];
      sum += (to - from) * input.x[std::min(ahead || j == 0 ? j : j - 1, last)];
      from = to;
    }
    out.emplace_back(sum / trial.dt);
  }
}

}  // namespace

void add_input(const Recording& recording, Utime origin, const ThrusterCorrection& correction,
               const model::Vehicle& vehicle, Trial& trial) {
  const Input input = read_input(recording, origin, correction, vehicle);
  trial.input_is_wrench = input.is_wrench;
  trial.input_step = typical_step(input.t);
  if (trial.input_step < kFaster * trial.dt) {
    trial.input_averaged = true;
    average(input, trial);
  } else {
    for (const double t : trial.t) trial.input.push_back(mean_around(input, t, 0.0));
    sample_held(input, trial, false, trial.held);
    sample_held(input, trial, true, trial.told);
  }
  for (std::size_t i = 0; i < trial.t.size() && !recording.battery.empty(); ++i) {
    trial.voltage.push_back(voltage_at(recording.battery, utime_after(origin, trial.t[i])));
  }
}

}  // namespace fathom::estimation
