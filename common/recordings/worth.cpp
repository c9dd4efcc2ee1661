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
template <class Sample>
double rate_of(const std::vector<Sample>& samples) {
  std::vector<Utime> steps;
  for (std::size_t i = 1; i < samples.size(); ++i) steps.push_back(samples[i].utime - samples[i - 1].utime);
  if (steps.empty()) return 0.0;
  const auto middle = steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2);
  std::nth_element(steps.begin(), middle, steps.end());
  return 1e6 / static_cast<double>(std::max<Utime>(*middle, 1));
}

/// Largest standard deviation of three components.
class Spread {
 public:
  void add(const Eigen::Vector3d& value) {
    ++count_;
    const Eigen::Vector3d step = value - mean_;
    mean_ += step / static_cast<double>(count_);
    squares_ += step.cwiseProduct(value - mean_);
    low_ = low_.cwiseMin(value);
    high_ = high_.cwiseMax(value);
  }
  [[nodiscard]] bool any() const { return count_ > 1; }
  [[nodiscard]] double deviation() const { return std::sqrt(squares_.maxCoeff() / static_cast<double>(count_ - 1)); }
  [[nodiscard]] double span() const { return (high_ - low_).maxCoeff(); }

 private:
  std::size_t count_{};
  Eigen::Vector3d mean_{Eigen::Vector3d::Zero()}, squares_{Eigen::Vector3d::Zero()};
  Eigen::Vector3d low_{Eigen::Vector3d::Constant(1e300)}, high_{Eigen::Vector3d::Constant(-1e300)};
};

void thrusters(const Recording& recording, const WorthThresholds& limits, std::vector<std::string>& found) {
  const std::vector<Thrusters>& all = recording.thrusters;
  if (all.empty()) {
    found.emplace_back("nothing says what the thrusters did: no motion can be explained");
    return;
  }
  const double rate = rate_of(all);
  if (all.size() > 1 && rate < limits.command_rate)
    found.push_back("thruster commands come at " + number("%.1f Hz", rate) +
                    ": what happens between them cannot be explained; log them at 10 Hz or more");
  double pulses = 0.0, forces = 0.0, largest = 0.0;
  const auto span = [&](auto&& value_of, std::size_t count) {
    double widest = 0.0;
    for (std::size_t i = 0; i < count; ++i) {
      double low = 1e300, high = -1e300;
      for (const Thrusters& one : all) {
        const auto& values = value_of(one);
        if (i >= values.size()) continue;
        low = std::min(low, values[i]);
        high = std::max(high, values[i]);
      }
      largest = std::max({largest, std::abs(low), std::abs(high)});
      widest = std::max(widest, high - low);
    }
    return widest;
  };
  const bool has_pulses = !all.front().pwm_us.empty();
  if (has_pulses)
    pulses = span(
        [](const Thrusters& one) -> const auto& { return one.pwm_us; }, all.front().pwm_us.size());
  largest = 0.0;
  const bool has_forces = !all.front().force.empty() || all.front().has_tau;
  if (!all.front().force.empty())
    forces = span(
        [](const Thrusters& one) -> const auto& { return one.force; }, all.front().force.size());
  if (all.front().has_tau)
    forces = std::max(forces, span(
                                  [](const Thrusters& one) -> const auto& { return one.tau; }, 6));
  if (has_pulses && !has_forces && pulses < limits.pulse_span)
    found.push_back("thruster pulses stay within " + number("%.0f us", pulses) + ": nothing was commanded");
  if (has_forces && forces <= limits.relative_span * largest)
    found.push_back("thrust never changes: nothing was commanded");
}

}  // namespace

std::vector<std::string> against_fitting(const Recording& recording, const WorthThresholds& limits) {
  std::vector<std::string> found;
  thrusters(recording, limits, found);
  Spread rates, velocity, position;
  for (const Ahrs& one : recording.ahrs) {
    if (one.has_rates) rates.add(one.w_WB_B);
  }
  for (const Dvl& one : recording.dvl) {
    if (one.valid) velocity.add(one.v_WB_B);
  }
  for (const PoseCapture& one : recording.pose_capture) {
    if (one.valid && one.has_position) position.add(one.p_WB);
  }
  if (!velocity.any() && !position.any())
    found.emplace_back("neither velocity nor position was measured: surge and sway cannot be identified");
  const bool still = (!rates.any() || rates.deviation() < limits.rate_spread) &&
                     (!velocity.any() || velocity.deviation() < limits.velocity_spread) &&
                     (!position.any() || position.span() < limits.position_span);
  if (still && (rates.any() || velocity.any() || position.any())) {
    std::string text = "the craft never moves";
    if (rates.any()) text += number(": rates scatter by %.4f rad/s", rates.deviation());
    if (velocity.any()) text += number(", velocity by %.3f m/s", velocity.deviation());
    if (position.any()) text += number(", position stays within %.3f m", position.span());
    found.push_back(text);
  }
  return found;
}

}  // namespace fathom::recordings
