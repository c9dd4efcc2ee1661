#include "common/recordings/table_draft.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <limits>
#include <numbers>
#include <vector>

#include "common/base/units.hpp"
#include "common/tables/likely_time.hpp"
#include "common/tables/map_writer.hpp"

namespace fathom::recordings {
namespace {

using tables::CsvTable;
using Names = std::vector<std::string>;

/// Names of one component, lower case. A name that begins with a point stands for every name that ends so.
using Choices = std::vector<const char*>;

struct Column {
  const std::string* name{};
  std::string bare;  ///< lower case, without a unit at its end
  std::string unit;
  double least{}, greatest{};
  std::size_t count{};
};

std::string lower(std::string text) {
  std::ranges::transform(text, text.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return text;
}

/// "surge_cm_s": a name that ends with its unit. Longer ones first.
constexpr std::array<std::pair<std::string_view, const char*>, 16> kEndings{{{"_deg_s", "deg/s"},
                                                                             {"_rad_s", "rad/s"},
                                                                             {"_m_s2", "m/s^2"},
                                                                             {"_mm_s", "mm/s"},
                                                                             {"_cm_s", "cm/s"},
                                                                             {"_deg", "deg"},
                                                                             {"_rad", "rad"},
                                                                             {"_m_s", "m/s"},
                                                                             {"_nm", "N m"},
                                                                             {"_mm", "mm"},
                                                                             {"_cm", "cm"},
                                                                             {"_kn", "kn"},
                                                                             {"_mv", "mV"},
                                                                             {"_n", "N"},
                                                                             {"_m", "m"},
                                                                             {"_v", "V"}}};

std::string number(double value) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.6g", value);
  return text.data();
}

class Columns {
 public:
  explicit Columns(const CsvTable& table) : table_{table} {
    for (std::size_t i = 0; i < table.names.size(); ++i) {
      Column column{.name = &table.names[i],
                    .bare = lower(table.names[i]),
                    .unit = table.units[i],
                    .least = std::numeric_limits<double>::infinity(),
                    .greatest = -std::numeric_limits<double>::infinity()};
      for (const double value : table.columns[i]) {
        if (!std::isfinite(value)) continue;
        ++column.count;
        column.least = std::min(column.least, value);
        column.greatest = std::max(column.greatest, value);
      }
      for (const auto& [ending, unit] : kEndings) {
        if (!column.bare.ends_with(ending) || column.bare.size() == ending.size()) continue;
        column.bare.resize(column.bare.size() - ending.size());
        if (column.unit.empty()) column.unit = unit;
        break;
      }
      all_.push_back(column);
    }
  }
  [[nodiscard]] const std::vector<Column>& all() const { return all_; }

  /// The column of the first choice that is there and holds numbers.
  [[nodiscard]] const Column* find(const Choices& choices) const {
    for (const std::string_view choice : choices) {
      for (std::size_t i = 0; i < all_.size(); ++i) {
        const std::string name = lower(*all_[i].name);
        const bool fits = choice.front() == '.' ? name.ends_with(choice) || name == choice.substr(1)
                                                : name == choice || all_[i].bare == choice;
        if (fits && all_[i].count > 0 && table_.faults[i].empty() && table_.cells_of(i) == tables::Cells::kNumbers)
          return &all_[i];
      }
    }
    return nullptr;
  }

 private:
  const CsvTable& table_;
  std::vector<Column> all_;
};

/// Up to as many columns as there are components.
struct Group {
  std::vector<const Column*> columns;

  Group(const Columns& all, const std::vector<Choices>& components) {
    for (const Choices& choices : components) columns.push_back(all.find(choices));
  }
  [[nodiscard]] std::size_t there() const {
    return static_cast<std::size_t>(std::ranges::count_if(columns, [](const Column* one) { return one != nullptr; }));
  }
  [[nodiscard]] bool whole() const { return there() == columns.size(); }
  [[nodiscard]] std::string list() const {
    std::string text = "[";
    for (const Column* one : columns)
      text += (text.size() > 1 ? ", " : "") + (one == nullptr ? "none" : tables::written_name(*one->name));
    return text + "]";
  }
  [[nodiscard]] double largest() const {
    double largest = 0.0;
    for (const Column* one : columns) {
      if (one != nullptr) largest = std::max({largest, std::abs(one->least), std::abs(one->greatest)});
    }
    return largest;
  }
  /// What a header says, where it is a unit of `dimension`; else `otherwise`.
  [[nodiscard]] std::string unit(const char* dimension, const std::string& otherwise) const {
    for (const Column* one : columns) {
      if (one == nullptr || one->unit.empty()) continue;
      try {
        static_cast<void>(unit_factor(one->unit, dimension));
        return one->unit;
      } catch (const std::exception&) {  // of another kind
      }
    }
    return otherwise;
  }
};

std::string vector_line(const char* key, const Group& group, const std::string& unit, const char* frame) {
  return std::string{"  "} + key + ": {columns: " + group.list() + ", unit: " + unit + ", frame: " + frame + "}\n";
}

/// Degrees where some value is beyond a full turn of radians; rates where they are faster than any craft turns.
std::string angle_unit(const Group& group) {
  return group.unit("rad", group.largest() > 2.0 * std::numbers::pi ? "deg" : "rad");
}
std::string rate_unit(const Group& group) {
  constexpr double kFastest = 6.0;  // rad/s
  return group.unit("rad/s", group.largest() > kFastest ? "deg/s" : "rad/s");
}

std::string attitude_of(const Columns& all) {
  const Group ros{all, {{".orientation.x"}, {".orientation.y"}, {".orientation.z"}, {".orientation.w"}}};
  if (ros.whole()) return "  quaternion: {columns: " + ros.list() + ", order: xyzw, world: ENU, body: FLU}\n";
  const Group wxyz{all, {{"qw", "q_w"}, {"qx", "q_x"}, {"qy", "q_y"}, {"qz", "q_z"}}};
  if (wxyz.whole()) return "  quaternion: {columns: " + wxyz.list() + ", order: wxyz, world: NED, body: FRD}\n";
  const Group euler{
      all, {{"phi", "roll", "m_roll"}, {"theta", "pitch", "m_pitch"}, {"psi", "yaw", "heading", "hdg", "m_heading"}}};
  if (euler.there() == 0) return "";
  return "  euler: {columns: " + euler.list() + ", unit: " + angle_unit(euler) + ", world: NED, body: FRD}\n";
}

/// Where north and east stand without a third, a depth in their unit is it; `with_depth` says so.
std::string position_of(const Columns& all, bool& with_depth) {
  const Group ros{all, {{".position.x"}, {".position.y"}, {".position.z"}}};
  if (ros.there() > 1) return vector_line("position", ros, ros.unit("m", "m"), "ENU");
  Group ned{all, {{"x", "north", "x_ned"}, {"y", "east", "y_ned"}, {"z", "down", "z_ned"}}};
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
                    {{"p", "roll_rate", "rollrate", "rollspeed", "wx", "gyrx", "gyr_x", "gyro_x"},
                     {"q", "pitch_rate", "pitchrate", "pitchspeed", "wy", "gyry", "gyr_y", "gyro_y"},
                     {"r", "yaw_rate", "yawrate", "yawspeed", "rot", "wz", "gyrz", "gyr_z", "gyro_z"}}};
  if (ros.there() > 0) {
    text += vector_line("rates", ros, rate_unit(ros), "FLU");
  } else if (rates.there() > 0) {
    text += vector_line("rates", rates, rate_unit(rates), "FRD");
  }
  const Group felt{all, {{".linear_acceleration.x"}, {".linear_acceleration.y"}, {".linear_acceleration.z"}}};
  const Group force{all, {{"ax", "accx", "acc_x"}, {"ay", "accy", "acc_y"}, {"az", "accz", "acc_z"}}};
  if (felt.whole()) text += vector_line("specific_force", felt, felt.unit("m/s^2", "m/s^2"), "FLU");
  if (force.whole()) text += vector_line("specific_force", force, force.unit("m/s^2", "m/s^2"), "FRD");
  return text;
}

std::string velocity_of(const Columns& all) {
  const Group ros{all, {{".linear.x"}, {".linear.y"}, {".linear.z"}}};
  if (ros.there() > 0) return vector_line("velocity", ros, ros.unit("m/s", "m/s"), "FLU");
  const Group body{all, {{"u", "surge", "vx"}, {"v", "sway", "vy"}, {"w", "heave", "vz"}}};
  if (body.there() > 0) return vector_line("velocity", body, body.unit("m/s", "m/s"), "FRD");
  const Group course{all, {{"cog", "course"}}}, speed{all, {{"sog", "speed"}}};
  if (!course.whole() || !speed.whole()) return "";
  return "  course: {column: " + tables::written_name(*course.columns[0]->name) + ", unit: " + angle_unit(course) +
         "}\n  speed: {column: " + tables::written_name(*speed.columns[0]->name) +
         ", unit: " + speed.unit("m/s", "m/s") + "}\n";
}

/// A wrench by its components; or what a Slocum drives itself by.
std::string forces_of(const Columns& all) {
  const Group wrench{all,
                     {{"fx", "force_x", "tau_x"},
                      {"fy", "force_y", "tau_y"},
                      {"fz", "force_z", "tau_z"},
                      {"mx", "torque_x", "moment_x", "tau_k"},
                      {"my", "torque_y", "moment_y", "tau_m"},
                      {"mz", "torque_z", "moment_z", "tau_n"}}};
  if (wrench.there() > 1)
    return "  wrench: {columns: " + wrench.list() + ", force_unit: N, moment_unit: N m, frame: FRD}\n";
  const Group glider{all, {{"m_ballast_pumped", "m_de_oil_vol"}, {"m_battpos"}}};
  if (!glider.whole()) return "";
  return "  # engine and battery, as 'fathom vehicle slocum' has them\n  inputs: {columns: " + glider.list() +
         ", units: [cc, in]}\n";
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

/// Columns whose name says pulses and whose numbers are such, in the order of the table.
std::string thrust_of(const Columns& all) {
  constexpr double kLeast = 800.0, kMost = 2200.0;  // us
  Names pulses;
  for (const Column& one : all.all()) {
    const std::string name = lower(*one.name);
    const bool named = name.starts_with("pwm") || name.starts_with("servo") || name.starts_with("rcou") ||
                       name.starts_with("thr") || name.starts_with("motor");
    if (named && one.count > 0 && one.least >= kLeast && one.greatest <= kMost && one.greatest > one.least)
      pulses.push_back(tables::written_name(*one.name));
  }
  if (pulses.empty()) return forces_of(all);
  std::string list;
  for (const std::string& one : pulses) list += (list.empty() ? "" : ", ") + one;
  return "  # they must be the thrusters of the vehicle file, in its order\n  pwm: {columns: [" + list +
         "], unit: us}\n";
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

std::string describe_table(const CsvTable& table) {
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
  const std::string streams =
      section("pose_capture", pose) + section("ahrs", inertial) + section("dvl", velocity_of(columns)) +
      section("depth", with_depth ? "" : scalar_of(columns, {"depth", "m_depth"}, "m", "  direction: down\n")) +
      section("thrusters", thrust_of(columns)) +
      section("battery", scalar_of(columns, {"voltage", "volt", "volts", "battery"}, "V", "")) +
      section("wind", wind_of(columns));
  if (time.empty() || streams.empty())
    return text + "# " + (time.empty() ? "No column looks like the time" : "No column has a usual name") +
           ": a map must be written by hand (docs/configuration.md).\n";
  return text +
         "# A draft of a map by the names of the columns, which runs as it is: check units, axes and what is missing.\n"
         "# 'none' is right only for axes along which the vehicle does not move (--vehicle).\n"
         "source: " +
         tables::written_name(std::filesystem::path(table.path).filename().string()) + "\nlicence: not stated\n" +
         time + streams;
}

}  // namespace fathom::recordings
