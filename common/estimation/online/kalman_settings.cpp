#include "common/estimation/online/kalman_settings.hpp"

#include "common/base/config.hpp"

namespace fathom::estimation {
namespace {

void read(const Config& config, const char* key, const char* unit, double& value) {
  if (config.has(key)) value = config.positive(key, unit);
}

void read(const Config& config, const char* key, const char* unit, Eigen::Vector3d& value) {
  if (!config.has(key)) return;
  const std::vector<double> numbers = config.quantities(key, unit);
  if (numbers.size() != 1 && numbers.size() != 3) config.fail(key, "one number for all axes, or three");
  for (int i = 0; i < 3; ++i) value[i] = numbers[numbers.size() == 1 ? 0 : static_cast<std::size_t>(i)];
  if (value.minCoeff() <= 0.0) config.fail(key, "must be positive");
}

model::Pose pose(const Config& config) {
  return {config.vector3("position", "m"), Eigen::Quaterniond{rotation_from_euler(config.vector3("rotation", "rad"))}};
}

void read_process(const Config& config, ProcessNoise& process) {
  read(config, "jerk", "m/s^2", process.jerk);
  read(config, "angular_jerk", "rad/s^2", process.angular_jerk);
  read(config, "velocity", "m/s", process.velocity);
  read(config, "accelerometer_bias", "m/s^2", process.accelerometer_bias);
  read(config, "gyro_bias", "rad/s", process.gyro_bias);
}

void read_inertial(const Config& config, KalmanSettings& s) {
  if (config.has("position")) s.p_BI = config.vector3("position", "m");
  if (config.has("rotation")) s.R_BI = rotation_from_euler(config.vector3("rotation", "rad"));
  read(config, "accelerometer_noise", "m/s^2", s.accelerometer_noise);
  read(config, "gyro_noise", "rad/s", s.gyro_noise);
  read(config, "accelerometer_bias", "m/s^2", s.accelerometer_bias);
  read(config, "gyro_bias", "rad/s", s.gyro_bias);
}

void read_attitude(const Config& config, KalmanSettings& s) {
  if (config.has("use")) {
    const std::string use = config.text("use");
    if (use != "nothing" && use != "heading" && use != "everything") {
      config.fail("use", "'use' must be nothing, heading or everything, not '" + use + "'");
    }
    s.attitude = use == "nothing"   ? AttitudeUse::kNothing
                 : use == "heading" ? AttitudeUse::kHeading
                                    : AttitudeUse::kEverything;
  }
  read(config, "noise", "rad", s.attitude_noise);
  if (config.has("memory")) s.attitude_memory = config.not_negative("memory", "s");
  if (config.has("heading_noise")) s.heading_noise = config.positive("heading_noise", "rad");
  if (config.has("declination")) s.declination = config.quantity("declination", "rad");
}

void read_ranges(const Config& config, KalmanSettings& s) {
  if (config.has("transducer")) s.p_BA = config.vector3("transducer", "m");
  read(config, "noise", "m", s.range_noise);
  if (!config.has("transponders")) return;
  for (const Config& one : config.list("transponders")) {
    s.transponders.push_back({one.text("name"), one.vector3("position", "m")});
    for (std::size_t i = 0; i + 1 < s.transponders.size(); ++i) {
      if (s.transponders[i].name == s.transponders.back().name) one.fail("name", "this transponder stands here twice");
    }
  }
}

void read_tags(const Config& config, KalmanSettings& s) {
  if (config.has("known")) {
    for (const Config& one : config.list("known")) s.tags.push_back({one.integer("tag"), pose(one)});
  }
  if (config.has("cameras")) {
    for (const Config& one : config.list("cameras")) s.cameras.push_back({one.text("name"), pose(one)});
  }
  read(config, "noise", "", s.tag_noise);
  read(config, "attitude_noise", "rad", s.tag_attitude_noise);
}

void read_start(const Config& config, KalmanSettings& s) {
  if (config.has("at")) s.start = config.vector3("at", "m");
  read(config, "position", "m", s.start_position);
  read(config, "velocity", "m/s", s.start_velocity);
  read(config, "tilt", "rad", s.start_tilt);
  read(config, "rates", "rad/s", s.start_rates);
  read(config, "acceleration", "m/s^2", s.start_acceleration);
}

}  // namespace

void KalmanSettings::add_singles(const std::vector<model::SingleInertialMount>& mounts) {
  for (const model::SingleInertialMount& mount : mounts) {
    const bool force = mount.measures == model::SingleInertialMount::Measures::kForce;
    process.single_bias[singles.size()] = force ? process.accelerometer_bias : process.gyro_bias;
    singles.push_back({mount, std::nullopt});
  }
}

std::optional<std::size_t> KalmanSettings::single(const std::string& signal) const {
  for (std::size_t i = 0; i < singles.size(); ++i) {
    if (singles[i].mount.signal == signal) return i;
  }
  return std::nullopt;
}

KalmanSettings KalmanSettings::from(const Config& config) {
  KalmanSettings s;
  if (config.has("filter")) static_cast<void>(config.text("filter"));  // whoever calls has chosen by it
  if (config.has("model")) {
    s.model = config.either("model", "coupled", "printed") ? KinematicModel::kCoupled : KinematicModel::kPrinted;
  }
  if (config.has("biases")) s.biases = config.flag("biases");
  read(config, "gate", "", s.gate);
  read(config, "latency", "s", s.latency);
  read(config, "max_gap", "s", s.max_gap);
  if (config.has("process")) read_process(config.section("process"), s.process);
  if (config.has("inertial")) read_inertial(config.section("inertial"), s);
  if (config.has("attitude")) read_attitude(config.section("attitude"), s);
  if (config.has("depth")) {
    const Config depth = config.section("depth");
    if (depth.has("position")) s.p_BP = depth.vector3("position", "m");
    read(depth, "noise", "m", s.depth_noise);
  }
  if (config.has("ranges")) read_ranges(config.section("ranges"), s);
  if (config.has("dvl")) {
    const Config dvl = config.section("dvl");
    read(dvl, "noise", "m/s", s.velocity_noise);
    if (dvl.has("bias")) s.velocity_bias = dvl.not_negative("bias", "m/s");
  }
  if (config.has("usbl")) read(config.section("usbl"), "noise", "m", s.usbl_noise);
  if (config.has("pose_capture")) {
    const Config capture = config.section("pose_capture");
    read(capture, "position_noise", "m", s.position_noise);
    read(capture, "attitude_noise", "rad", s.capture_attitude_noise);
  }
  if (config.has("tags")) read_tags(config.section("tags"), s);
  if (config.has("start")) read_start(config.section("start"), s);
  return s;
}

}  // namespace fathom::estimation
