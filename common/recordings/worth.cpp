#include "common/recordings/worth.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

namespace fathom::recordings {
namespace {

std::string number(const char* format, double value) {
  std::array<char, 48> text{};
  std::snprintf(text.data(), text.size(), format, value);
  return text.data();
}

/// Hz, from the median step.
double rate_of(std::vector<Utime> steps) {
  if (steps.empty()) return 0.0;
  const auto middle = steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2);
  std::nth_element(steps.begin(), middle, steps.end());
  return 1e6 / static_cast<double>(std::max<Utime>(*middle, 1));
}

constexpr std::size_t kMostSteps = 100'000;  // enough for a median

}  // namespace

void Spread::add(const Eigen::Vector3d& value) {
  ++count_;
  const Eigen::Vector3d step = value - mean_;
  mean_ += step / static_cast<double>(count_);
  squares_ += step.cwiseProduct(value - mean_);
  low_ = low_.cwiseMin(value);
  high_ = high_.cwiseMax(value);
}

double Spread::deviation() const { return std::sqrt(squares_.maxCoeff() / static_cast<double>(count_ - 1)); }

double Spread::size() const {
  return std::sqrt((squares_ / static_cast<double>(count_) + mean_.cwiseAbs2()).maxCoeff());
}

void Worth::Ranges::add(std::span<const double> values) {
  if (low.size() < values.size()) {
    low.resize(values.size(), 1e300);
    high.resize(values.size(), -1e300);
  }
  for (std::size_t i = 0; i < values.size(); ++i) {
    low[i] = std::min(low[i], values[i]);
    high[i] = std::max(high[i], values[i]);
  }
}

double Worth::Ranges::widest() const {
  double widest = 0.0;
  for (std::size_t i = 0; i < low.size(); ++i) widest = std::max(widest, high[i] - low[i]);
  return widest;
}

double Worth::Ranges::widest_share() const {
  double widest = 0.0;
  for (std::size_t i = 0; i < low.size(); ++i) {
    const double size = std::max(std::abs(low[i]), std::abs(high[i]));
    if (size > 0.0) widest = std::max(widest, (high[i] - low[i]) / size);
  }
  return widest;
}

double Worth::Ranges::largest() const {
  double largest = 0.0;
  for (std::size_t i = 0; i < low.size(); ++i) largest = std::max({largest, std::abs(low[i]), std::abs(high[i])});
  return largest;
}

void Worth::take(const Recording& part) {
  for (const Thrusters& one : part.thrusters) {
    pulses_.add(one.pwm_us);
    forces_.add(one.force);
    if (one.has_tau) wrench_.add(one.tau);
    if (latest_ && steps_.size() < kMostSteps) steps_.push_back(one.utime - *latest_);
    latest_ = one.utime;
  }
  for (const Ahrs& one : part.ahrs) {
    if (one.has_rates) rates_.add(one.w_WB_B);
  }
  for (const Dvl& one : part.dvl) {
    if (one.valid) velocity_.add(one.v_WB_B);
  }
  for (const PoseCapture& one : part.pose_capture) {
    if (one.valid && one.has_position) position_.add(one.p_WB);
  }
  positioned_ = positioned_ || !part.state.empty() || !part.usbl.empty() || !part.tag_pose.empty();
}

void Worth::thrusters(const WorthThresholds& limits, std::vector<std::string>& found) const {
  if (!latest_) {
    found.emplace_back("nothing says what the thrusters did: no motion can be explained");
    return;
  }
  const double rate = rate_of(steps_);
  if (!steps_.empty() && rate < limits.command_rate)
    found.push_back("thruster commands come at " + number("%.1f Hz", rate) +
                    ": what happens between them cannot be explained; log them at 10 Hz or more");
  const bool has_pulses = !pulses_.low.empty(), has_forces = !forces_.low.empty() || !wrench_.low.empty();
  // Commands may be shaft speeds and angles as well (rad/s, rad): those are judged by their own size.
  const bool are_pulses = has_pulses && pulses_.largest() >= limits.least_pulse;
  if (are_pulses && !has_forces && pulses_.widest() < limits.pulse_span)
    found.push_back("thruster pulses stay within " + number("%.0f us", pulses_.widest()) + ": nothing was commanded");
  if (has_pulses && !are_pulses && !has_forces && pulses_.widest_share() <= limits.relative_span)
    found.emplace_back("commands never change: nothing was commanded");
  if (has_forces && std::max(forces_.widest(), wrench_.widest()) <=
                        limits.relative_span * std::max(forces_.largest(), wrench_.largest()))
    found.emplace_back("thrust never changes: nothing was commanded");
}

std::vector<std::string> Worth::against_fitting(const WorthThresholds& limits) const {
  std::vector<std::string> found;
  thrusters(limits, found);
  if (!velocity_.any() && !position_.any() && !positioned_)
    found.emplace_back("neither velocity nor position was measured: surge and sway cannot be identified");
  const bool still = (!rates_.any() || rates_.deviation() < limits.rate_spread) &&
                     (!velocity_.any() || velocity_.size() < limits.velocity_size) &&
                     (!position_.any() || position_.span() < limits.position_span);
  if (still && (rates_.any() || velocity_.any() || position_.any())) {
    std::string text = "the craft never moves:";
    if (rates_.any()) text += number(" rates scatter by %.4f rad/s,", rates_.deviation());
    if (velocity_.any()) text += number(" velocity is %.3f m/s (RMS),", velocity_.size());
    if (position_.any()) text += number(" position stays within %.3f m,", position_.span());
    text.pop_back();
    found.push_back(text);
  }
  return found;
}

std::vector<std::string> against_fitting(const Recording& recording, const WorthThresholds& limits) {
  Worth worth;
  worth.take(recording);
  return worth.against_fitting(limits);
}

}  // namespace fathom::recordings
