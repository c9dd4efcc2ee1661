#include "common/recordings/table_draft.hpp"

#include <array>
#include <cstdio>
#include <filesystem>

#include "common/recordings/draft_columns.hpp"
#include "common/recordings/draft_thrust.hpp"
#include "common/tables/likely_time.hpp"
#include "common/tables/map_writer.hpp"

namespace fathom::recordings {
namespace {

std::string number(double value) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.6g", value);
  return text.data();
}

std::string attitude_of(const Columns& all) {
  const Group ros{all, {{".orientation.x"}, {".orientation.y"}, {".orientation.z"}, {".orientation.w"}}};
  if (ros.whole()) return "  quaternion: {columns: " + ros.list() + ", order: xyzw, world: ENU, body: FLU}\n";
  const Group wxyz{all, {{"qw", "q_w"}, {"qx", "q_x"}, {"qy", "q_y"}, {"qz", "q_z"}}};
  if (wxyz.whole()) return "  quaternion: {columns: " + wxyz.list() + ", order: wxyz, world: NED, body: FRD}\n";
  const Group euler{
      all,
      {{"phi", "roll", "m_roll", "roll_angle"},
       {"theta", "pitch", "m_pitch", "pitch_angle"},
       {"psi", "yaw", "heading", "hdg", "m_heading", "yaw_angle", "heading_angle", "true_heading", "heading_true"}}};
  if (euler.there() == 0) return "";
  return "  euler: {columns: " + euler.list() + ", unit: " + angle_unit(euler) + ", world: NED, body: FRD}\n";
}

/// Where north and east stand without a third, a depth in their unit is it; `with_depth` says so.
std::string position_of(const Columns& all, bool& with_depth) {
  const Group ros{all, {{".position.x"}, {".position.y"}, {".position.z"}}};
  if (ros.there() > 1) return vector_line("position", ros, ros.unit("m", "m"), "ENU");
  Group ned{all,
            {{"x", "north", "x_ned", "pos_x", "pos_n", "pos_north", "northing", "x_n"},
             {"y", "east", "y_ned", "pos_y", "pos_e", "pos_east", "easting", "y_e"},
             {"z", "down", "z_ned", "pos_z", "pos_d", "pos_down"}}};
  const Column* depth = all.find({"depth"});
  with_depth = ned.columns[0] != nullptr && ned.columns[1] != nullptr && ned.columns[2] == nullptr &&
               depth != nullptr && depth->unit == ned.columns[0]->unit;
  if (with_depth) ned.columns[2] = depth;
  if (ned.there() > 1) return vector_line("position", ned, ned.unit("m", "m"), "NED");
  const Group globe{all, {{"lat", "latitude"}, {"lon", "lng", "longitude"}}};
  return globe.whole() ? "  geodetic: {columns: " + globe.list() + ", unit: deg}\n" : "";
}

std::string inertial_of(const Columns& all) {
  std::string text;
  const Group ros{all,
                  {{".angular_velocity.x", ".angular.x"},
                   {".angular_velocity.y", ".angular.y"},
                   {".angular_velocity.z", ".angular.z"}}};
  const Group rates{all,
                    {{"p", "roll_rate", "rollrate", "rollspeed", "roll_speed", "wx", "gyrx", "gyr_x", "gyro_x", "gx",
                      "ang_vel_x", "ang_rate_x", "omega_x"},
                     {"q", "pitch_rate", "pitchrate", "pitchspeed", "pitch_speed", "wy", "gyry", "gyr_y", "gyro_y",
                      "gy", "ang_vel_y", "ang_rate_y", "omega_y"},
                     {"r", "yaw_rate", "yawrate", "yawspeed", "yaw_speed", "rot", "rate_of_turn", "turn_rate", "wz",
                      "gyrz", "gyr_z", "gyro_z", "gz", "ang_vel_z", "ang_rate_z", "omega_z"}}};
  if (ros.there() > 0) {
    text += vector_line("rates", ros, rate_unit(ros), "FLU");
  } else if (rates.there() > 0) {
    text += vector_line("rates", rates, rate_unit(rates), "FRD");
  }
  const Group felt{all, {{".linear_acceleration.x"}, {".linear_acceleration.y"}, {".linear_acceleration.z"}}};
  const Group force{all,
                    {{"ax", "accx", "acc_x", "lin_acc_x"},
                     {"ay", "accy", "acc_y", "lin_acc_y"},
                     {"az", "accz", "acc_z", "lin_acc_z"}}};
  if (felt.whole()) text += vector_line("specific_force", felt, felt.unit("m/s^2", "m/s^2"), "FLU");
  if (force.whole()) text += vector_line("specific_force", force, force.unit("m/s^2", "m/s^2"), "FRD");
  return text;
}

std::string velocity_of(const Columns& all) {
  const Group ros{all, {{".linear.x"}, {".linear.y"}, {".linear.z"}}};
  if (ros.there() > 0) return vector_line("velocity", ros, ros.unit("m/s", "m/s"), "FLU");
  const Group body{all,
                   {{"u", "surge", "vx", "surge_vel", "vel_x", "v_x", "vel_u", "fore_vel"},
                    {"v", "sway", "vy", "sway_vel", "vel_y", "v_y", "vel_v"},
                    {"w", "heave", "vz", "heave_vel", "vel_z", "v_z", "vel_w"}}};
  if (body.there() > 0) return vector_line("velocity", body, body.unit("m/s", "m/s"), "FRD");
  const Group world{all,
                    {{"vn", "vel_n", "vel_north", "v_n", "v_north"},
                     {"ve", "vel_e", "vel_east", "v_e", "v_east"},
                     {"vd", "vel_d", "vel_down", "v_d", "v_down"}}};
  if (world.there() > 1) return vector_line("velocity", world, world.unit("m/s", "m/s"), "NED");
  const Group course{all, {{"cog", "course", "course_over_ground"}}},
      speed{all, {{"sog", "speed", "speed_over_ground"}}};
  if (!course.whole() || !speed.whole()) return "";
  return "  course: {column: " + tables::written_name(*course.columns[0]->name) + ", unit: " + angle_unit(course) +
         "}\n  speed: {column: " + tables::written_name(*speed.columns[0]->name) +
         ", unit: " + speed.unit("m/s", "m/s") + "}\n";
}

/// Wind in knots or m/s as its header says; directions are those from which it blows.
std::string wind_of(const Columns& all) {
  for (const bool apparent : {true, false}) {
    const Group speed{all, {{apparent ? "aws" : "tws"}}}, from{all, {{apparent ? "awa" : "twd"}}};
    if (speed.there() + from.there() == 0) continue;
    std::string text = std::string{"  reference: "} + (apparent ? "apparent" : "true") + "\n";
    if (speed.whole())
      text += "  speed: {column: " + tables::written_name(*speed.columns[0]->name) +
              ", unit: " + speed.unit("m/s", "m/s") + "}\n";
    if (from.whole())
      text +=
          "  from: {column: " + tables::written_name(*from.columns[0]->name) + ", unit: " + angle_unit(from) + "}\n";
    return text;
  }
  return "";
}

std::string scalar_of(const Columns& all, const Choices& choices, const char* dimension, const char* more) {
  const Group group{all, {choices}};
  if (!group.whole()) return "";
  return "  column: " + tables::written_name(*group.columns[0]->name) +
         "\n  unit: " + group.unit(dimension, dimension) + "\n" + more;
}

std::string section(const char* name, const std::string& lines) {
  return lines.empty() ? "" : std::string{name} + ":\n" + lines;
}

}  // namespace

std::string describe_table(const tables::CsvTable& table, const std::vector<Commanded>& actuators) {
  const Columns columns{table};
  std::string text = "# " + table.path + ": table, " + std::to_string(table.rows()) + " rows of " +
                     std::to_string(table.names.size()) + " columns\n#\n# column [unit]: numbers, least to greatest\n";
  for (std::size_t i = 0; i < table.names.size(); ++i) {
    const Column& one = columns.all()[i];
    text += "# " + *one.name + (one.unit.empty() ? "" : " [" + one.unit + "]") + ": ";
    if (table.cells_of(i) != tables::Cells::kNumbers) {
      text += "dates\n";
    } else if (one.count == 0) {
      text += table.faults[i].empty() ? "empty\n" : "words\n";
    } else {
      text += std::to_string(one.count) + ", " + number(one.least) + " to " + number(one.greatest) +
              (table.faults[i].empty() ? "" : "; words beside them") + "\n";
    }
  }
  text += "#\n";
  const auto likely = tables::likely_time(table);
  const std::string time = likely ? likely->key + "\n" : "";
  bool with_depth = false;
  std::string pose = position_of(columns, with_depth), attitude = attitude_of(columns), inertial = inertial_of(columns);
  (pose.empty() ? inertial : pose) += attitude;
  const ThrustDraft thrust = thrust_of(columns, actuators);
  const std::string streams =
      section("pose_capture", pose) + section("ahrs", inertial) + section("dvl", velocity_of(columns)) +
      section("depth", with_depth ? "" : scalar_of(columns, {"depth", "m_depth"}, "m", "  direction: down\n")) +
      section("thrusters", thrust.lines) +
      section("battery", scalar_of(columns,
                                   {"voltage", "volt", "volts", "battery", "battery_voltage", "vbat", "vbatt",
                                    "bat_voltage", "batt_voltage", "supply_voltage"},
                                   "V", "")) +
      section("wind", wind_of(columns));
  if (time.empty() || streams.empty())
    return text + "# " + (time.empty() ? "No column looks like the time" : "No column has a usual name") +
           ": a map must be written by hand (docs/configuration.md).\n";
  return text +
         "# A draft of a map by the names of the columns, which runs as it is: check units, axes and what is missing.\n"
         "# 'none' is right only for axes along which the vehicle does not move (--vehicle).\n"
         "source: " +
         tables::written_name(std::filesystem::path(table.path).filename().string()) + "\nlicence: not stated\n" +
         time + streams + thrust.remark;
}

}  // namespace fathom::recordings
