#include "common/tables/writer.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <fstream>
#include <limits>
#include <span>
#include <vector>

#include "common/base/error.hpp"
#include "common/base/spatial.hpp"

namespace fathom::tables {
namespace {

// Columns that are filled together, with the stamps at which they are.
struct Series {
  std::vector<std::string> names;
  std::vector<Utime> utime;
  std::vector<double> values;  // names.size() per stamp

  void add(Utime stamp, std::span<const double> row) {
    if (row.size() != names.size()) return;  // a thruster count that changes in mid-run has no column
    utime.push_back(stamp);
    values.insert(values.end(), row.begin(), row.end());
  }
  void add(Utime stamp, const Eigen::Vector3d& row) { add(stamp, std::span<const double>(row.data(), 3)); }
};

std::vector<std::string> numbered(const std::string& prefix, std::size_t count) {
  std::vector<std::string> names;
  for (std::size_t i = 1; i <= count; ++i) names.push_back(prefix + std::to_string(i));
  return names;
}

void append_number(std::string& text, double value) {
  std::array<char, 32> buffer{};
  const auto result = std::to_chars(buffer.data(), buffer.data() + buffer.size(), value);
  text.append(buffer.data(), result.ptr);
}

// Seconds with six decimals, exact: no floating point is involved.
void append_time(std::string& text, Utime utime) {
  const auto magnitude = static_cast<std::uint64_t>(utime < 0 ? -utime : utime);
  if (utime < 0) text += '-';
  text += std::to_string(magnitude / 1'000'000U) + '.';
  const std::string micro = std::to_string(magnitude % 1'000'000U);
  text.append(6 - micro.size(), '0').append(micro);
}

std::string merge(const std::vector<Series>& all) {
  std::vector<const Series*> series;
  std::vector<Utime> stamps;
  std::string text = "t";
  for (const Series& one : all) {
    if (one.utime.empty()) continue;
    series.push_back(&one);
    stamps.insert(stamps.end(), one.utime.begin(), one.utime.end());
    for (const std::string& name : one.names) text += ',' + name;
  }
  text += '\n';
  std::sort(stamps.begin(), stamps.end());
  stamps.erase(std::unique(stamps.begin(), stamps.end()), stamps.end());
  std::vector<std::size_t> cursor(series.size(), 0);
  for (const Utime stamp : stamps) {
    append_time(text, stamp);
    for (std::size_t s = 0; s < series.size(); ++s) {
      const Series& one = *series[s];
      const std::size_t width = one.names.size();
      while (cursor[s] < one.utime.size() && one.utime[cursor[s]] < stamp) ++cursor[s];
      const bool here = cursor[s] < one.utime.size() && one.utime[cursor[s]] == stamp;
      for (std::size_t i = 0; i < width; ++i) {
        text += ',';
        if (here) append_number(text, one.values[cursor[s] * width + i]);
      }
    }
    text += '\n';
  }
  return text;
}

const std::vector<std::string> kPosition{"x", "y", "z"};
const std::vector<std::string> kEuler{"phi", "theta", "psi"};
const std::vector<std::string> kWrench{"X", "Y", "Z", "K", "M", "N"};

Eigen::Vector3d euler_of(const Eigen::Quaterniond& q_WB) { return euler_from_rotation(q_WB.toRotationMatrix()); }

}  // namespace

std::string to_csv(const Recording& recording) {
  Series position{kPosition, {}, {}};
  Series attitude{kEuler, {}, {}};
  for (const PoseCapture& pose : recording.pose_capture) {
    if (!pose.valid) continue;
    if (pose.has_position) position.add(pose.utime, pose.p_WB);
    if (pose.has_attitude) attitude.add(pose.utime, euler_of(pose.q_WB));
  }
  const bool attitude_from_ahrs = attitude.utime.empty();
  Series rates{{"p", "q", "r"}, {}, {}};
  Series specific_force{{"ax", "ay", "az"}, {}, {}};
  for (const Ahrs& sample : recording.ahrs) {
    if (sample.has_rates) rates.add(sample.utime, sample.w_WB_B);
    if (sample.has_specific_force) specific_force.add(sample.utime, sample.f_B);
    if (sample.has_attitude && attitude_from_ahrs) attitude.add(sample.utime, euler_of(sample.q_WB));
  }
  Series velocity{{"u", "v", "w"}, {}, {}};
  for (const Dvl& sample : recording.dvl) {
    if (sample.valid && !sample.held) velocity.add(sample.utime, sample.v_WB_B);
  }
  Series depth{{"depth"}, {}, {}};
  for (const Depth& sample : recording.depth) depth.add(sample.utime, std::span<const double>(&sample.z, 1));
  const std::size_t pwm_count = recording.thrusters.empty() ? 0 : recording.thrusters.front().pwm_us.size();
  const std::size_t force_count = recording.thrusters.empty() ? 0 : recording.thrusters.front().force.size();
  Series pwm{numbered("pwm", pwm_count), {}, {}};
  Series force{numbered("f", force_count), {}, {}};
  Series wrench{kWrench, {}, {}};
  for (const Thrusters& sample : recording.thrusters) {
    if (pwm_count > 0) pwm.add(sample.utime, sample.pwm_us);
    if (force_count > 0) force.add(sample.utime, sample.force);
    if (sample.has_tau) wrench.add(sample.utime, sample.tau);
  }
  Series voltage{{"voltage"}, {}, {}};
  for (const Battery& sample : recording.battery)
    voltage.add(sample.utime, std::span<const double>(&sample.voltage, 1));
  return merge({position, attitude, velocity, rates, specific_force, pwm, force, wrench, depth, voltage});
}

std::string to_csv(const Trial& trial) {
  const std::size_t inputs = trial.input.empty() ? 0 : static_cast<std::size_t>(trial.input.front().size());
  Series position{kPosition, {}, {}};
  Series attitude{kEuler, {}, {}};
  Series velocity{{"u", "v", "w"}, {}, {}};
  Series rates{{"p", "q", "r"}, {}, {}};
  Series input{trial.input_is_wrench ? kWrench : numbered("f", inputs), {}, {}};
  Series voltage{{"voltage"}, {}, {}};
  for (std::size_t k = 0; k < trial.size(); ++k) {
    const Utime utime = utime_after(0, trial.t[k]);
    if (trial.pose_valid[k] != 0) {
      if (trial.observed.position) position.add(utime, trial.p_WB[k]);
      if (trial.observed.attitude) attitude.add(utime, euler_of(trial.q_WB[k]));
    }
    if (trial.observed.velocity && trial.velocity_valid[k] != 0) velocity.add(utime, trial.nu[k].head<3>());
    if (trial.observed.rates && trial.rates_valid[k] != 0) rates.add(utime, trial.nu[k].tail<3>());
    if (inputs > 0 && (trial.input_valid.empty() || trial.input_valid[k] != 0)) {
      input.add(utime, std::span<const double>(trial.input[k].data(), static_cast<std::size_t>(trial.input[k].size())));
    }
    if (!trial.voltage.empty()) voltage.add(utime, std::span<const double>(&trial.voltage[k], 1));
  }
  return merge({position, attitude, velocity, rates, input, voltage});
}

void write_file(const std::string& path, const std::string& text) {
  std::ofstream file(path, std::ios::binary);
  file << text;
  file.close();
  if (!file) throw InputError(path + ": cannot write this file");
}

}  // namespace fathom::tables
