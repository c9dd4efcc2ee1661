#include "common/estimation/corrections_file.hpp"

#include <algorithm>
#include <array>
#include <cstdio>
#include <map>

#include "common/base/config.hpp"
#include "common/base/error.hpp"
#include "common/base/spatial.hpp"

namespace fathom::estimation {
namespace {

constexpr std::array<const char*, 4> kForms{"as_read", "inverse", "scalar_last", "scalar_last_inverse"};
constexpr std::array<const char*, 3> kSenses{"as_read", "from_east", "anticlockwise"};

std::string number(double value) {
  std::array<char, 32> buffer{};
  std::snprintf(buffer.data(), buffer.size(), "%.9g", value == 0.0 ? 0.0 : value);  // no "-0"
  return buffer.data();
}

std::string numbers(const Eigen::Ref<const Eigen::MatrixXd>& m, const char* unit) {  // row by row
  std::string text;
  for (Eigen::Index i = 0; i < m.rows(); ++i) {
    for (Eigen::Index j = 0; j < m.cols(); ++j) text += (text.empty() ? "" : " ") + number(m(i, j));
  }
  return *unit == '\0' ? "\"" + text + "\"" : text + " " + unit;
}

Eigen::Matrix3d matrix(const Config& section, const std::string& key, const char* unit) {
  const std::vector<double> values = section.quantities(key, unit);
  if (values.size() != 9) section.fail(key, key + " needs nine numbers, row by row");
  return Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(values.data());
}

// An accelerometer at a lever feels w' x r + w x (w x r), which no matrix on the rates can say.
std::string accelerometer(const Corrections& c) {
  return "  accelerometer:  # corrected = matrix * logged + bias, at the lever; stamps as the gyro's\n    matrix: " +
         numbers(c.accelerometer.matrix(), "") + "\n    bias: " + numbers(c.accelerometer.bias, "m/s^2") +
         "\n    lever: " + numbers(c.accelerometer.lever, "m") + "\n";
}

std::string sensor(const char* name, const SensorFault& fault, double shift, const char* unit) {
  // The lever's cross product and the coupling act on the rates as one matrix.
  const Eigen::Matrix3d from_rates = skew(fault.lever) + fault.coupling;
  return std::string("  ") + name + ":\n    matrix: " + numbers(fault.matrix(), "") +
         "  # corrected = matrix * logged + bias + from_rates * rates\n    bias: " + numbers(fault.bias, unit) +
         "\n    from_rates: " + numbers(from_rates, "m") + "\n    shift: " + number(shift) +
         " s  # added to the time stamps\n";
}

void read_sensor(const Config& parent, const std::string& key, const char* unit, SensorFault& fault, double& shift) {
  if (!parent.has(key)) return;
  const Config section = parent.section(key);
  fault.base = matrix(section, "matrix", "");
  fault.bias = section.vector3("bias", unit);
  fault.coupling = matrix(section, "from_rates", "m");
  shift = section.quantity("shift", "s");
}

}  // namespace

std::string to_yaml(const Corrections& c) {
  std::string text =
      "# What is done to the sensors' signals before they are used. Written by fathom check; matrices row by row.\n"
      "corrections:\n  pose_capture:\n    quaternion: ";
  text += kForms[static_cast<std::size_t>(c.quaternion)];
  text += std::string("\n    heading_sense: ") + kSenses[static_cast<std::size_t>(c.heading_sense)] +
          "\n    attitude_world: " + numbers(c.attitude_world, "");
  text += "\n    heading: " + number(c.heading) + " rad\n    attitude_axes: " + numbers(c.attitude_axes, "") +
          "\n    position_axes: " + numbers(c.position_axes, "") + "\n    position_scale: " + number(c.position_scale) +
          "\n    shift: " + number(c.pose_shift) + " s\n";
  text += sensor("gyro", c.gyro, c.gyro_shift, "rad/s") + sensor("dvl", c.dvl, c.dvl_shift, "m/s") + accelerometer(c);
  text += std::string("  thrusters:\n    use_commands: ") + (c.thrusters.use_commands ? "true" : "false") +
          "  # false: logged forces or the logged wrench\n    scale: " + number(c.thrusters.scale) +
          "\n    exponent: " + number(c.thrusters.exponent) + "\n";
  return text;
}

Corrections corrections_from(const Config& section) {
  Corrections c;
  if (section.has("pose_capture")) {
    const Config pose = section.section("pose_capture");
    const std::string form = pose.text("quaternion");
    std::size_t i = 0;
    while (i < kForms.size() && form != kForms[i]) ++i;
    if (i == kForms.size()) {
      pose.fail("quaternion",
                "quaternion is '" + form + "'; write as_read, inverse, scalar_last or scalar_last_inverse");
    }
    c.quaternion = static_cast<QuaternionForm>(i);
    if (pose.has("heading_sense")) {
      const std::string sense = pose.text("heading_sense");
      const auto found = std::ranges::find(kSenses, sense);
      if (found == kSenses.end())
        pose.fail("heading_sense", "heading_sense is '" + sense + "'; write as_read, from_east or anticlockwise");
      c.heading_sense = static_cast<HeadingSense>(found - kSenses.begin());
    }
    if (pose.has("attitude_world")) c.attitude_world = matrix(pose, "attitude_world", "");
    c.heading = pose.quantity("heading", "rad");
    c.attitude_axes = matrix(pose, "attitude_axes", "");
    c.position_axes = matrix(pose, "position_axes", "");
    c.position_scale = pose.quantity("position_scale", "");
    c.pose_shift = pose.quantity("shift", "s");
  }
  if (section.has("accelerometer")) {
    const Config part = section.section("accelerometer");
    c.accelerometer.base = matrix(part, "matrix", "");
    c.accelerometer.bias = part.vector3("bias", "m/s^2");
    c.accelerometer.lever = part.vector3("lever", "m");
  }
  read_sensor(section, "gyro", "rad/s", c.gyro, c.gyro_shift);
  read_sensor(section, "dvl", "m/s", c.dvl, c.dvl_shift);
  if (section.has("thrusters")) {
    const Config thrusters = section.section("thrusters");
    c.thrusters.use_commands = thrusters.flag("use_commands");
    c.thrusters.scale = thrusters.quantity("scale", "");
    c.thrusters.exponent = thrusters.quantity("exponent", "");
  }
  return c;
}

Corrections load_corrections(const std::string& path) {
  const Config file = Config::load(path);
  Corrections c = corrections_from(file.section("corrections"));
  file.finish();
  return c;
}

Shared most_shared(std::span<const Corrections> corrections) {
  std::map<std::string, Shared> groups;
  std::size_t most = 0;
  for (const Corrections& one : corrections) {
    Shared& group = groups[to_yaml(one)];
    if (group.count == 0) group.corrections = one;
    most = std::max(most, ++group.count);
  }
  for (const Corrections& one : corrections) {  // the first in the order of the recordings
    const Shared& group = groups[to_yaml(one)];
    if (group.count == most) return group;
  }
  return {};
}

}  // namespace fathom::estimation
