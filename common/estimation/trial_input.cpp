#include "common/estimation/trial_input.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/base/error.hpp"
#include "common/estimation/thruster_forces.hpp"
#include "common/estimation/timeline.hpp"
#include "common/model/rollout.hpp"

namespace fathom::estimation {
namespace {

constexpr double kFaster = 0.75;       // of the grid's step: inputs closer than that are averaged over it
constexpr double kPartOfDecay = 0.25;  // spread evenly over a part, inputs take 0.3 % off the quickest inertia
constexpr int kMostParts = 8;
constexpr double kCommandLife = 0.3;  // s: drivers let go of an older command, so it may not be held for longer
constexpr double kFewSteps = 2.5;     // of the input's own: rows of so slow an input are no gap
constexpr double kRegular = 0.9;      // of the steps are short: the input is told at a rate, not when it changes
constexpr double kSameTime = 1e-6;    // s: stamps are whole microseconds

/// Input over time: thruster forces or the wrench, one row per sample of the stream.
struct Input {
  std::vector<double> t;
  std::vector<Eigen::VectorXd> x;
  bool is_wrench{false};
};

Input read_input(const Recording& recording, Utime origin, const ThrusterCorrection& correction,
                 const model::Vehicle& vehicle) {
  Input input;
  const auto thrusters = static_cast<std::size_t>(vehicle.allocation.cols());
  for (const Thrusters& one : recording.thrusters) {
    Eigen::VectorXd x;
    bool wrench = false;
    if (one.force.size() == thrusters && thrusters > 0) {
      x = Eigen::Map<const Eigen::VectorXd>(one.force.data(), static_cast<Eigen::Index>(one.force.size()));
    } else if (correction.use_commands && one.pwm_us.size() == vehicle.thrusters.size()) {
      const double voltage =
          recording.battery.empty() ? reference_voltage(vehicle) : voltage_at(recording.battery, one.utime);
      const std::vector<double> force = forces_of(correction, vehicle, one.pwm_us, voltage);
      x = Eigen::Map<const Eigen::VectorXd>(force.data(), static_cast<Eigen::Index>(force.size()));
    } else if (one.has_tau) {
      x = Eigen::Map<const Eigen::VectorXd>(one.tau.data(), 6);
      wrench = true;
    } else if (!one.force.empty()) {
      throw InputError(recording.name + ": forces of " + std::to_string(one.force.size()) +
                       " thrusters, and the vehicle file has " + std::to_string(thrusters) +
                       (thrusters == 0
                            ? ": list them there ('thrusters', with position and axis), or give the wrench (X ... N)"
                            : ": give a column (f1, f2, ...) for each in the file's order, zeros for one that was off, "
                              "or the wrench (X ... N)"));
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

/// Mean over [from, end) if every input holds until the next one, or `ahead`, from the one before on.
Eigen::VectorXd mean_held(const Input& input, double from, double end, bool ahead) {
  const std::size_t last = input.t.size() - 1;
  const double length = end - from;
  const auto after = std::upper_bound(input.t.begin(), input.t.end(), from + kSameTime);
  Eigen::VectorXd sum = Eigen::VectorXd::Zero(input.x.front().size());
  for (auto j = static_cast<std::size_t>(after - input.t.begin()); from < end - kSameTime; ++j) {  // rows j - 1 and j
    const double to = j > last || input.t[j] >= end - kSameTime ? end : input.t[j];
    sum += (to - from) * input.x[std::min(ahead || j == 0 ? j : j - 1, last)];
    from = to;
  }
  return sum / length;
}

/// Over which no input was recorded that was due. s on the trial's clock.
struct Gap {
  double begin, end;
};

/// Whether nothing was measured in the middle of a gap: then the whole recording pauses.
bool silent(const Recording& recording, Utime origin, const Gap& gap) {
  const double margin = 0.25 * (gap.end - gap.begin);
  const Utime from = utime_after(origin, gap.begin + margin), to = utime_after(origin, gap.end - margin);
  const auto says_nothing = [&](const auto& stream) {
    const auto next = std::ranges::lower_bound(stream, from, {}, [](const auto& one) { return one.utime; });
    return next == stream.end() || next->utime >= to;
  };
  return says_nothing(recording.pose_capture) && says_nothing(recording.ahrs) && says_nothing(recording.dvl);
}

/// Longer than a few steps, than what moves the vehicle may be spread over, and than a command lives. An input that is
/// told only when it changes has gaps where the whole recording has one.
std::vector<Gap> gaps_of(const Recording& recording, Utime origin, const Input& input, const Trial& trial) {
  const double few = kFewSteps * trial.input_step;
  const double longest = std::max(few, std::min(trial.input_part, kCommandLife));
  std::vector<Gap> gaps;
  std::size_t brief = 0;
  for (std::size_t i = 1; i < input.t.size(); ++i) {
    const Gap gap{input.t[i - 1], input.t[i]};
    if (gap.end - gap.begin <= few + kSameTime) ++brief;
    if (gap.end - gap.begin > longest + kSameTime) gaps.push_back(gap);
  }
  if (static_cast<double>(brief) < kRegular * static_cast<double>(input.t.size() - 1)) {
    std::erase_if(gaps, [&](const Gap& gap) { return !silent(recording, origin, gap); });
    return gaps;
  }
  constexpr double kForever = std::numeric_limits<double>::infinity();
  if (input.t.size() > 1) {
    gaps.insert(gaps.begin(), {-kForever, input.t.front() - longest});
    gaps.push_back({input.t.back() + longest, kForever});
  }
  return gaps;
}

/// 0 within a gap, and where a mean over `reach` to both sides draws on one.
std::vector<std::uint8_t> outside(const std::vector<Gap>& gaps, const std::vector<double>& grid, double reach) {
  std::vector<std::uint8_t> valid(grid.size(), 1);
  for (const Gap& gap : gaps) {
    auto k = static_cast<std::size_t>(std::ranges::upper_bound(grid, gap.begin - reach + kSameTime) - grid.begin());
    for (; k < grid.size() && grid[k] < gap.end + reach - kSameTime; ++k) valid[k] = 0;
  }
  return valid;
}

/// Parts of a step, each with a mean of its own: no more than there are inputs to tell of, nor than the vehicle's
/// quickest axis can tell apart. A mean over a part acts as if spread over it, and a fit takes that off the inertia.
int parts_of(const Trial& trial) {
  const double needed = std::ceil(trial.dt / trial.input_part - 1e-9);
  const double told = std::ceil(trial.dt / trial.input_step - 0.05);  // stamps may jitter
  return static_cast<int>(std::clamp(std::min(needed, told), 1.0, static_cast<double>(kMostParts)));
}

void sample_held(const Input& input, const Averaging& averaging, bool ahead, int parts, const Trial& trial,
                 std::vector<Eigen::VectorXd>& out) {
  const double length = trial.dt / parts;
  for (const double t : trial.t) {
    for (int part = 0; part < parts; ++part) {
      Eigen::VectorXd sum = Eigen::VectorXd::Zero(input.x.front().size());
      for (int k = 0; k < averaging.samples; ++k) {
        const double from = t + part * length + (k - 0.5 * (averaging.samples - 1)) * averaging.step;
        sum += mean_held(input, from, from + length, ahead);
      }
      out.emplace_back(sum / averaging.samples);
    }
  }
}

}  // namespace

void add_input(const Recording& recording, Utime origin, const ThrusterCorrection& correction,
               const model::Vehicle& vehicle, const Averaging& averaging, Trial& trial) {
  const Input input = read_input(recording, origin, correction, vehicle);
  trial.input_is_wrench = input.is_wrench;
  trial.input_step = typical_step(input.t);
  trial.input_part = kPartOfDecay * model::quickest_decay(vehicle);
  trial.input_averaged = trial.input_step < kFaster * trial.dt;
  for (const double t : trial.t) trial.input.push_back(mean_around(input, t, trial.input_averaged ? trial.dt : 0.0));
  const bool means = trial.input_averaged || averaging.samples > 1;
  trial.input_valid = outside(gaps_of(recording, origin, input, trial), trial.t, means ? 0.5 * trial.dt : 0.0);
  const int parts = parts_of(trial);
  sample_held(input, averaging, false, parts, trial, trial.held);
  sample_held(input, averaging, true, parts, trial, trial.told);
  for (std::size_t i = 0; i < trial.t.size() && !recording.battery.empty(); ++i) {
    trial.voltage.push_back(voltage_at(recording.battery, utime_after(origin, trial.t[i])));
  }
}

}  // namespace fathom::estimation
