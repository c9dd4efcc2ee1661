#include "common/recordings/usual_topics.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <cstdio>
#include <string_view>

#include "common/tables/map_writer.hpp"

namespace fathom::recordings {
namespace {

using Names = std::vector<std::string>;

constexpr double kLeastPulse = 800.0, kMostPulse = 2200.0;     // us: what a speed controller takes
constexpr double kNeutralPulse = 1500.0, kNeutralBand = 30.0;  // us: where it stands still

const char* const kEstimate =
    "an estimate of the autopilot, no measurement: right only where nothing else is there, and then what agrees with "
    "it "
    "proves nothing";

/// The columns of a topic, as a map writes them.
class Columns {
 public:
  explicit Columns(const TopicAccount& topic) : topic_(topic) {}

  [[nodiscard]] bool has(const Names& names) const {
    return std::ranges::all_of(names, [&](const std::string& name) { return find(name) != nullptr; });
  }
  [[nodiscard]] std::string list(const Names& names) const {
    std::string text = "[";
    for (const std::string& name : names)
      text += (text.size() > 1 ? ", " : "") + tables::written_name(topic_.topic.name + "." + name);
    return text + "]";
  }
  [[nodiscard]] std::string one(const std::string& name) const {
    return tables::written_name(topic_.topic.name + "." + name);
  }
  [[nodiscard]] const FieldAccount* find(const std::string& name) const {
    for (std::size_t i = 0; i < topic_.topic.fields.size(); ++i) {
      if (topic_.topic.fields[i].name == name) return &topic_.fields[i];
    }
    return nullptr;
  }
  [[nodiscard]] bool known(const std::string& name) const {
    const FieldAccount* field = find(name);
    return field != nullptr && field->finite > 0;
  }
  /// "not measured", as ROS says it: -1 in the first place of a covariance.
  [[nodiscard]] bool unmeasured(const std::string& covariance) const {
    const FieldAccount* field = find(covariance + "[0]");
    return field != nullptr && field->finite > 0 && field->least == -1.0;
  }

 private:
  const TopicAccount& topic_;
};

Names numbered(const std::string& begin, const std::string& end, int first, int count) {
  Names names;
  for (int i = first; i < first + count; ++i) names.push_back(begin + std::to_string(i) + end);
  return names;
}

Names with(const std::string& begin, const Names& ends) {
  Names names;
  for (const std::string& end : ends) names.push_back(begin + end);
  return names;
}

std::string vector_line(const char* key, const Columns& columns, const Names& names, const char* unit,
                        const char* frame) {
  return std::string{key} + ": {columns: " + columns.list(names) + ", unit: " + unit + ", frame: " + frame + "}";
}

std::string euler_line(const Columns& columns, const Names& names, const char* unit) {
  return "euler: {columns: " + columns.list(names) + ", unit: " + unit + ", world: NED, body: FRD}";
}

std::string quaternion_line(const Columns& columns, const Names& names, const char* order, const char* frames) {
  return "quaternion: {columns: " + columns.list(names) + ", order: " + order + ", " + frames + "}";
}

const char* const kRosFrames = "world: ENU, body: FLU";
const char* const kPilotFrames = "world: NED, body: FRD";

/// Outputs that drive something: those that move and what stands at neutral between and beside them (a thruster that
/// was not used); where none moves, all that stand at neutral, else all with a pulse.
std::optional<Entry> pulses(const Columns& columns, const Names& outputs, const std::string& topic, int rank) {
  enum class Use : std::uint8_t { kNone, kStill, kNeutral, kMoving };
  std::vector<Use> uses;
  for (const std::string& name : outputs) {
    const FieldAccount* field = columns.find(name);
    const bool pulse = field != nullptr && field->finite > 0 && field->greatest >= kLeastPulse &&
                       field->greatest <= kMostPulse && (field->least >= kLeastPulse || field->least == 0.0);
    const bool moving = pulse && field->changes > 0 && field->greatest - std::max(field->least, kLeastPulse) > 1.0;
    const bool neutral = pulse && std::abs(field->greatest - kNeutralPulse) <= kNeutralBand;
    uses.push_back(!pulse ? Use::kNone : moving ? Use::kMoving : neutral ? Use::kNeutral : Use::kStill);
  }
  const bool any_moves = std::ranges::count(uses, Use::kMoving) > 0;
  const Use seed = any_moves ? Use::kMoving : std::ranges::count(uses, Use::kNeutral) > 0 ? Use::kNeutral : Use::kStill;
  const auto first = std::ranges::find(uses, seed);
  if (first == uses.end()) return std::nullopt;
  std::size_t begin = static_cast<std::size_t>(first - uses.begin());
  std::size_t end = begin;
  for (std::size_t i = begin;
       i < uses.size() && (uses[i] == seed || uses[i] == Use::kNeutral || uses[i] == Use::kMoving); ++i)
    end = i + 1;
  while (begin > 0 && uses[begin - 1] == Use::kNeutral) --begin;
  Names used(outputs.begin() + static_cast<std::ptrdiff_t>(begin), outputs.begin() + static_cast<std::ptrdiff_t>(end));
  Entry entry{.quantity = Quantity::kThrust, .rank = rank, .topic = topic, .lines = {}, .remark = {}};
  entry.lines.push_back("pwm: {columns: " + columns.list(used) + ", unit: us}");
  entry.remark = std::string{any_moves ? "the first outputs that move" : "no output moves: those with a pulse"} +
                 "; they must be the thrusters of the vehicle file, in its order";
  return entry;
}

std::string pressure_line(const Columns& columns, const std::string& name, const char* unit) {
  const FieldAccount* field = columns.find(name);
  std::array<char, 64> surface{};
  std::snprintf(surface.data(), surface.size(), "%.7g %s", field == nullptr ? 0.0 : field->least, unit);
  return "pressure: {column: " + columns.one(name) + ", unit: " + unit + ", surface: " + surface.data() +
         ", density: 1000 kg/m^3}";
}

const char* const kSurface =
    "'surface' is the least pressure of the file, right if the craft was at the surface once; density: fresh water";

using Out = std::vector<Entry>;

void ardupilot(const TopicAccount& topic, const Columns& c, Out& out) {
  const std::string& type = topic.topic.type;
  const std::string& name = topic.topic.name;
  const auto add = [&](Quantity quantity, int rank, Names lines, std::string remark = {}, bool drafted = true) {
    out.push_back({quantity, rank, name, std::move(lines), std::move(remark), drafted});
  };
  const Names gyro{"GyrX", "GyrY", "GyrZ"}, acc{"AccX", "AccY", "AccZ"}, angles{"Roll", "Pitch", "Yaw"};
  if (type.starts_with("IMU") && c.has(gyro) && c.has(acc))
    add(Quantity::kInertial, name == "IMU" || name == "IMU[0]" ? 0 : 1,
        {vector_line("rates", c, gyro, "rad/s", "FRD"), vector_line("specific_force", c, acc, "m/s^2", "FRD")});
  if (type == "ATT" && c.has(angles)) add(Quantity::kAttitude, 1, {euler_line(c, angles, "deg")});
  if (type == "AHR2" && c.has(angles)) add(Quantity::kAttitude, 3, {euler_line(c, angles, "deg")});
  if (type == "VISP" && c.has({"PX", "PY", "PZ"}) && c.has(angles))
    add(Quantity::kPose, 1, {vector_line("position", c, {"PX", "PY", "PZ"}, "m", "NED"), euler_line(c, angles, "deg")});
  if (type == "VISO" && c.known("VelX"))
    add(Quantity::kVelocity, 1, {vector_line("velocity", c, {"VelX", "VelY", "VelZ"}, "m/s", "FRD")},
        "shift over time, as a velocity log sends it through an autopilot");
  if ((type == "XKF1" || type == "NKF1") && c.has({"PN", "PE", "PD"}))
    add(Quantity::kPose, 8, {vector_line("position", c, {"PN", "PE", "PD"}, "m", "NED"), euler_line(c, angles, "deg")},
        kEstimate, false);
  if (type == "BARO" && c.has({"Alt"})) {
    const bool first = name == "BARO" || name == "BARO[0]";
    add(Quantity::kDepth, first ? 5 : 1, {"column: " + c.one("Alt"), "unit: m", "direction: up"},
        first ? "the barometer on the board, in a sealed hull: no depth, unless the board is open to the water" : "",
        !first);
  }
  if (type == "RCOU") {
    if (auto entry = pulses(c, numbered("C", "", 1, 16), name, 1)) out.push_back(*entry);
  }
  if ((type == "BAT" || type == "CURR") && c.known("Volt"))
    add(Quantity::kBattery, name.ends_with("[1]") ? 3 : 1, {"column: " + c.one("Volt"), "unit: V"});
}

void mavlink(const TopicAccount& topic, const Columns& c, Out& out) {
  const std::string& type = topic.topic.type;
  const std::string& name = topic.topic.name;
  const int other = name.find('@') == std::string::npos ? 0 : 10;  // not the autopilot's word
  const auto add = [&](Quantity quantity, int rank, Names lines, std::string remark = {}, bool drafted = true) {
    out.push_back({quantity, rank + other, name, std::move(lines), std::move(remark), drafted});
  };
  const Names gyro{"xgyro", "ygyro", "zgyro"}, acc{"xacc", "yacc", "zacc"}, angles{"roll", "pitch", "yaw"},
      p{"x", "y", "z"};
  if (type == "HIGHRES_IMU")
    add(Quantity::kInertial, 0,
        {vector_line("rates", c, gyro, "rad/s", "FRD"), vector_line("specific_force", c, acc, "m/s^2", "FRD")});
  if (type == "RAW_IMU" || type == "SCALED_IMU" || type == "SCALED_IMU2" || type == "SCALED_IMU3")
    add(Quantity::kInertial,
        type == "RAW_IMU"      ? 2
        : type == "SCALED_IMU" ? 1
                               : 3,
        {vector_line("rates", c, gyro, "mrad/s", "FRD"), vector_line("specific_force", c, acc, "mG", "FRD")},
        type == "RAW_IMU" ? "units as ArduPilot sends them; others leave RAW_IMU raw" : "");
  if (type == "ATTITUDE") {
    add(Quantity::kAttitude, 1, {euler_line(c, angles, "rad")});
    add(Quantity::kInertial, 5, {vector_line("rates", c, {"rollspeed", "pitchspeed", "yawspeed"}, "rad/s", "FRD")});
  }
  if (type == "ATTITUDE_QUATERNION")
    add(Quantity::kAttitude, 2, {quaternion_line(c, {"q1", "q2", "q3", "q4"}, "wxyz", kPilotFrames)});
  if (type == "ATT_POS_MOCAP")
    add(Quantity::kPose, 0,
        {vector_line("position", c, p, "m", "NED"),
         quaternion_line(c, numbered("q[", "]", 0, 4), "wxyz", kPilotFrames)});
  if (type == "VISION_POSITION_ESTIMATE" || type == "VICON_POSITION_ESTIMATE" ||
      type == "GLOBAL_VISION_POSITION_ESTIMATE")
    add(Quantity::kPose, 1, {vector_line("position", c, p, "m", "NED"), euler_line(c, angles, "rad")});
  if (type == "LOCAL_POSITION_NED")
    add(Quantity::kPose, 8, {vector_line("position", c, p, "m", "NED")}, kEstimate, false);
  if (type == "VISION_POSITION_DELTA")
    add(Quantity::kVelocity, 1, {vector_line("velocity", c, numbered("velocity[", "]", 0, 3), "m/s", "FRD")},
        "shift over time, as a velocity log sends it through an autopilot");
  if (type == "VISION_SPEED_ESTIMATE")
    add(Quantity::kVelocity, 4, {vector_line("velocity", c, p, "m/s", "FRD")}, "in the world's axes by its definition",
        false);
  if ((type == "SCALED_PRESSURE2" || type == "SCALED_PRESSURE3") && c.known("press_abs"))
    add(Quantity::kDepth, type == "SCALED_PRESSURE2" ? 1 : 2, {pressure_line(c, "press_abs", "hPa")}, kSurface);
  if (type == "SCALED_PRESSURE" && c.known("press_abs"))
    add(Quantity::kDepth, 6, {pressure_line(c, "press_abs", "hPa")},
        "the barometer on the board, in a sealed hull: no depth", false);
  if (type == "SERVO_OUTPUT_RAW") {
    if (auto entry = pulses(c, numbered("servo", "_raw", 1, 16), name, 1 + other)) out.push_back(*entry);
  }
  if (type == "ACTUATOR_OUTPUT_STATUS") {
    if (auto entry = pulses(c, numbered("actuator[", "]", 0, 32), name, 2 + other)) out.push_back(*entry);
  }
  if (type == "SYS_STATUS") add(Quantity::kBattery, 1, {"column: " + c.one("voltage_battery"), "unit: mV"});
  if (type == "BATTERY_STATUS")
    add(Quantity::kBattery, 2, {"column: " + c.one("voltages[0]"), "unit: mV"},
        "the first cell, or all of them together");
}

void px4(const TopicAccount& topic, const Columns& c, Out& out) {
  const std::string& type = topic.topic.type;
  const std::string& name = topic.topic.name;
  const auto add = [&](Quantity quantity, int rank, Names lines, std::string remark = {}, bool drafted = true) {
    out.push_back({quantity, rank, name, std::move(lines), std::move(remark), drafted});
  };
  const Names p = c.has({"position[0]"}) ? numbered("position[", "]", 0, 3) : Names{"x", "y", "z"};
  const Names q = numbered("q[", "]", 0, 4);
  const Names gyro = numbered("gyro_rad[", "]", 0, 3), acc = numbered("accelerometer_m_s2[", "]", 0, 3);
  if (type == "sensor_combined" && c.has(gyro) && c.has(acc))
    add(Quantity::kInertial, 0,
        {vector_line("rates", c, gyro, "rad/s", "FRD"), vector_line("specific_force", c, acc, "m/s^2", "FRD")});
  if (type == "vehicle_angular_velocity" && c.has(numbered("xyz[", "]", 0, 3)))
    add(Quantity::kInertial, 2, {vector_line("rates", c, numbered("xyz[", "]", 0, 3), "rad/s", "FRD")});
  if (type == "vehicle_attitude" && c.has(q))
    add(Quantity::kAttitude, 1, {quaternion_line(c, q, "wxyz", kPilotFrames)});
  if ((type == "vehicle_visual_odometry" || type == "vehicle_mocap_odometry") && c.has(p) && c.has(q))
    add(Quantity::kPose, type == "vehicle_mocap_odometry" ? 0 : 1,
        {vector_line("position", c, p, "m", "NED"), quaternion_line(c, q, "wxyz", kPilotFrames)});
  if ((type == "vehicle_odometry" || type == "vehicle_local_position") && c.has(p))
    add(Quantity::kPose, 8, {vector_line("position", c, p, "m", "NED")}, kEstimate, false);
  if (type == "actuator_outputs") {
    if (auto entry =
            pulses(c, numbered("output[", "]", 0, 16), name, name.ends_with("]") && !name.ends_with("[0]") ? 2 : 1))
      out.push_back(*entry);
  }
  if (type == "battery_status" && c.known("voltage_v"))
    add(Quantity::kBattery, 1, {"column: " + c.one("voltage_v"), "unit: V"});
  if (type == "sensor_baro" || type == "vehicle_air_data") {
    const char* pressure = c.has({"pressure"}) ? "pressure" : "baro_pressure_pa";
    if (c.known(pressure))
      add(Quantity::kDepth, 6,
          {pressure_line(c, pressure, c.has({"pressure"}) && c.find("pressure")->greatest < 5000.0 ? "hPa" : "Pa")},
          "the barometer on the board: no depth, unless it is open to the water", false);
  }
}

void ros_topics(const TopicAccount& topic, const Columns& c, Out& out) {
  std::string type = topic.topic.type;  // pkg/msg/Type and pkg/Type are the same
  if (const auto msg = type.find("/msg/"); msg != std::string::npos) type.erase(msg, 4);
  const std::string& name = topic.topic.name;
  std::string lower = name;
  std::ranges::transform(lower, lower.begin(), [](unsigned char ch) { return static_cast<char>(std::tolower(ch)); });
  const auto says = [&](std::string_view word) { return lower.find(word) != std::string::npos; };
  const bool asked =
      says("cmd") || says("command") || says("setpoint") || says("reference") || says("desired") || says("target");
  const auto add = [&](Quantity quantity, int rank, Names lines, std::string remark = {}, bool drafted = true) {
    out.push_back({quantity, rank, name, std::move(lines), std::move(remark), drafted});
  };
  const Names xyz{"x", "y", "z"}, xyzw{"x", "y", "z", "w"};
  const std::string frames = "frames as REP 103 has them: ENU and FLU";
  if (type == "sensor_msgs/Imu") {
    Names lines;
    if (!c.unmeasured("angular_velocity_covariance"))
      lines.push_back(vector_line("rates", c, with("angular_velocity.", xyz), "rad/s", "FLU"));
    if (!c.unmeasured("linear_acceleration_covariance"))
      lines.push_back(vector_line("specific_force", c, with("linear_acceleration.", xyz), "m/s^2", "FLU"));
    const FieldAccount* w = c.find("orientation.w");
    const bool oriented = w != nullptr && w->finite > 0 && !c.unmeasured("orientation_covariance") &&
                          !(w->least == w->greatest && (w->least == 0.0 || w->least == 1.0));
    if (oriented) lines.push_back(quaternion_line(c, with("orientation.", xyzw), "xyzw", kRosFrames));
    if (!lines.empty()) add(Quantity::kInertial, says("raw") ? 1 : 0, lines, frames);
  }
  const auto pose_lines = [&](const std::string& at) {
    return Names{vector_line("position", c, with(at + "position.", xyz), "m", "ENU"),
                 quaternion_line(c, with(at + "orientation.", xyzw), "xyzw", kRosFrames)};
  };
  if (!asked) {
    if (type == "geometry_msgs/PoseStamped") add(Quantity::kPose, 1, pose_lines("pose."), frames);
    if (type == "geometry_msgs/PoseWithCovarianceStamped") add(Quantity::kPose, 2, pose_lines("pose.pose."), frames);
    if (type == "geometry_msgs/Pose") add(Quantity::kPose, 3, pose_lines(""), frames + "; no time of measurement");
    if (type == "nav_msgs/Odometry") {
      add(Quantity::kPose, 4, pose_lines("pose.pose."), frames + "; often an estimate, not a measurement");
      add(Quantity::kVelocity, 6, {vector_line("velocity", c, with("twist.twist.linear.", xyz), "m/s", "FLU")},
          "of the same estimate as the pose: where they agree, that proves nothing");
    }
    if (type == "geometry_msgs/TwistStamped")
      add(Quantity::kVelocity, 2, {vector_line("velocity", c, with("twist.linear.", xyz), "m/s", "FLU")}, frames);
    if (type == "geometry_msgs/TwistWithCovarianceStamped")
      add(Quantity::kVelocity, 1, {vector_line("velocity", c, with("twist.twist.linear.", xyz), "m/s", "FLU")}, frames);
  }
  const bool dvl = type.ends_with("/DVL") || type.ends_with("/Dvl") || type.ends_with("/DVLVelocity");
  if (dvl && c.has(with("velocity.", xyz))) {
    Names lines{vector_line("velocity", c, with("velocity.", xyz), "m/s", "FRD")};
    if (c.known("altitude")) lines.push_back("altitude: {column: " + c.one("altitude") + ", unit: m}");
    add(Quantity::kVelocity, 0, lines, "axes as the instrument is mounted: FRD where it looks down and forward");
  }
  if (type == "geometry_msgs/WrenchStamped" || type == "geometry_msgs/Wrench") {
    const std::string at = type.ends_with("Stamped") ? "wrench." : "";
    Names six = with(at + "force.", xyz);
    for (const std::string& each : with(at + "torque.", xyz)) six.push_back(each);
    add(Quantity::kThrust, 1, {"wrench: {columns: " + c.list(six) + ", force_unit: N, moment_unit: N m, frame: FLU}"},
        "what is asked for, unless somebody measured it; frame as REP 103 has it");
  }
  if ((type == "mavros_msgs/RCOut") && c.has({"channels[0]"})) {
    if (auto entry = pulses(c, numbered("channels[", "]", 0, 18), name, 2)) out.push_back(*entry);
  }
  if (type == "std_msgs/UInt16MultiArray" || type == "std_msgs/Int16MultiArray") {
    if (auto entry = pulses(c, numbered("data[", "]", 0, 16), name, 4)) out.push_back(*entry);
  }
  if (type == "sensor_msgs/FluidPressure") {
    const bool board = says("mavros") && !says("pressure2") && !says("diff");
    add(Quantity::kDepth, board ? 6 : 1, {pressure_line(c, "fluid_pressure", "Pa")},
        board ? "the barometer on the board, in a sealed hull: no depth" : kSurface, !board && !says("diff"));
  }
  if (type == "sensor_msgs/BatteryState" && c.known("voltage"))
    add(Quantity::kBattery, 1, {"column: " + c.one("voltage"), "unit: V"});
}

}  // namespace

std::vector<Entry> entries_of(const TopicAccount& topic) {
  std::vector<Entry> out;
  const Columns columns{topic};
  if (topic.topic.type.starts_with("arrays of ")) {
    named_arrays(topic, out);
  } else if (topic.topic.type.find('/') != std::string::npos) {
    ros_topics(topic, columns, out);
  } else {
    ardupilot(topic, columns, out);
    mavlink(topic, columns, out);
    px4(topic, columns, out);
  }
  return out;
}

}  // namespace fathom::recordings
