#include "common/tables/map_writer.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <cstdio>
#include <initializer_list>
#include <span>

#include "common/base/error.hpp"
#include "common/base/units.hpp"

namespace fathom::tables {
namespace {

using Names = std::initializer_list<const char*>;
constexpr double kSameFactor = 1e-6;  // relative

std::string listed(std::span<const Column> columns) {
  std::string text = "[";
  for (const Column& column : columns)
    text += (text.size() > 1 ? ", " : "") + (column.absent ? "none" : written_name(column.name));
  return text + "]";
}

std::string unit_of(double factor, const char* si, const Names& others) {
  if (std::abs(factor - 1.0) < kSameFactor) return si;
  for (const char* unit : others) {
    if (std::abs(factor / unit_factor(unit, si) - 1.0) < kSameFactor) return unit;
  }
  char text[64];
  std::snprintf(text, sizeof text, "%.9g", factor);
  throw InputError(std::string("no unit of a map makes a factor of ") + text + " to " + si +
                   "; multiply the columns by it");
}

const Eigen::Matrix3d kFlip = Eigen::Vector3d(1.0, -1.0, -1.0).asDiagonal();
const Eigen::Matrix3d kEnu = (Eigen::Matrix3d() << 0, 1, 0, 1, 0, 0, 0, 0, -1).finished();

std::string world_of(const Eigen::Matrix3d& axes) {
  if (axes.isIdentity(1e-9)) return "NED";
  if (axes.isApprox(kFlip, 1e-9)) return "NWU";
  if (axes.isApprox(kEnu, 1e-9)) return "ENU";
  throw InputError("no name of a map (NED, NWU, ENU) says how these world axes are turned; reorder the columns");
}
std::string body_of(const Eigen::Matrix3d& axes) {
  if (axes.isIdentity(1e-9)) return "FRD";
  if (axes.isApprox(kFlip, 1e-9)) return "FLU";
  throw InputError("no name of a map (FRD, FLU) says how these body axes are turned; reorder the columns");
}

std::string angle(double radians) {
  char text[48];
  std::snprintf(text, sizeof text, "%.4f deg", radians / kDegree);
  return text;
}

std::string vector(const ColumnGroup& group, const std::string& frame, const char* si, const Names& units) {
  return "{columns: " + listed(group.columns) + ", unit: " + unit_of(group.factor, si, units) + ", frame: " + frame +
         "}";
}

std::string column_and_unit(const ColumnGroup& group, const char* si, const Names& units) {
  return "column: " + written_name(group.columns.front().name) + ", unit: " + unit_of(group.factor, si, units);
}
std::string scalar(const ColumnGroup& group, const char* si, const Names& units) {
  return "{" + column_and_unit(group, si, units) + "}";
}

const Names kLengths{"mm", "cm", "km", "ft"}, kSpeeds{"mm/s", "cm/s", "km/h", "kn", "ft/s"}, kAngles{"deg", "mrad"},
    kRates{"deg/s", "mrad/s", "rpm"}, kTimes{"ms", "us", "ns", "min", "h"}, kForces{"kN"}, kVoltages{"mV"},
    kPressures{"hPa", "kPa", "MPa", "mbar", "dbar", "bar"};

std::string attitude(const AttitudeColumns& columns, const std::string& indent) {
  std::string text =
      indent + (columns.euler ? "euler: " : "quaternion: ") + "{columns: " + listed(columns.group.columns);
  double offset = columns.heading_offset;
  if (columns.euler) {
    text += ", unit: " + unit_of(columns.group.factor, "rad", kAngles);
    if (columns.heading_sign < 0.0) {
      const bool east = std::abs(offset - 90.0 * kDegree) < 45.0 * kDegree;
      text += std::string(", heading: ") + (east ? "from_east" : "anticlockwise");
      offset -= east ? 90.0 * kDegree : 0.0;
    }
  } else {
    if (columns.heading_sign < 0.0) throw InputError("no key of a map mirrors the heading of a quaternion");
    text += ", order: wxyz";
    if (columns.world_to_body) text += ", turns: world_to_body";
  }
  if (std::abs(offset) > 1e-9) text += ", heading_offset: " + angle(offset);
  return text + ", world: " + world_of(columns.world_to_house) + ", body: " + body_of(columns.body_to_house) + "}\n";
}

std::string flags(const std::vector<Column>& columns, const std::string& indent) {
  std::vector<Column> invalid, valid;
  for (const Column& column : columns) (column.negated ? valid : invalid).push_back(column);
  std::string text;
  if (!invalid.empty()) text += indent + "invalid_where: " + listed(invalid) + "\n";
  if (!valid.empty()) text += indent + "valid_where: " + listed(valid) + "\n";
  return text;
}

std::string held(const HeldRule& rule, const std::string& indent) {
  if (rule.detect) return indent + "held: detect\n";
  if (!rule.flag) return {};
  return indent + "held: {column: " + written_name(rule.flag->name) + "}\n";
}

std::string depth(const ScalarColumn& column) {
  ColumnGroup group = column.group;
  std::string text = "depth:\n";
  if (column.weight > 0.0) {
    constexpr double kGravity = 9.80665;  // m/s^2
    group.factor *= column.weight;
    std::array<char, 96> more{};
    std::snprintf(more.data(), more.size(), ", surface: %.10g Pa, density: %.10g kg/m^3}\n",
                  std::abs(column.offset * column.weight), column.weight / kGravity);
    text += "  pressure: {" + column_and_unit(group, "Pa", kPressures) + more.data();
  } else {
    const bool up = group.factor < 0.0;
    group.factor = std::abs(group.factor);
    text += "  column: " + written_name(group.columns.front().name) +
            "\n  unit: " + unit_of(group.factor, "m", kLengths) + "\n  direction: " + (up ? "up" : "down") + "\n";
  }
  return text + flags(column.invalid_where, "  ");
}

std::string battery(const ScalarColumn& column) {
  return "battery:\n  column: " + written_name(column.group.columns.front().name) +
         "\n  unit: " + unit_of(column.group.factor, "V", kVoltages) + "\n" + flags(column.invalid_where, "  ");
}

std::string list(const char* name, const ListColumns& columns, const char* si, const Names& units) {
  return std::string{name} + ":\n  columns: " + listed(columns.group.columns) +
         "\n  unit: " + unit_of(columns.group.factor, si, units) + "\n" + flags(columns.invalid_where, "  ");
}

std::string number_of(double value) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.10g", value);
  return text.data();
}
std::string with_unit(double value, const char* unit) { return number_of(value) + " " + unit; }

std::string usbl(const UsblColumns& columns) {
  std::string text =
      "usbl:\n  position: " + vector(columns.position, world_of(columns.position.to_house), "m", kLengths) +
      "\n  sigma: ";
  text += columns.sigma ? "{columns: " + listed(columns.sigma->columns) +
                              ", unit: " + unit_of(columns.sigma->factor, "m", kLengths) + "}"
                        : with_unit(columns.stated_sigma, "m");
  return text + "\n" + flags(columns.invalid_where, "  ");
}

/// "tag: {column: id}" or "tag: 7"; nothing where a number is not stated.
std::string column_or_number(const char* name, const ColumnOrNumber& value, const char* si, const Names& units) {
  const std::string key = std::string{"  "} + name + ": ";
  if (!value.group)
    return value.number ? key + number_of(*value.number) + (*si != 0 ? std::string{" "} + si : "") + "\n" : "";
  if (*si == 0) return key + "{column: " + written_name(value.group->columns.front().name) + "}\n";
  return key + scalar(*value.group, si, units) + "\n";
}

std::string vector_in_camera(const char* name, const ColumnGroup& group, const char* si, const Names& units) {
  return std::string{"  "} + name + ": {columns: " + listed(group.columns) +
         ", unit: " + unit_of(group.factor, si, units) + "}\n";
}

std::string cameras(const ColumnMap& map) {
  std::string text;
  if (const auto& tags = map.tag_pose)
    text += "tag_pose:\n  camera: " + written_name(tags->camera) + "\n" + column_or_number("tag", tags->tag, "", {}) +
            vector_in_camera("position", tags->position, "m", kLengths) +
            "  quaternion: {columns: " + listed(tags->quaternion.columns) + ", order: wxyz}\n" +
            column_or_number("reprojection_error", tags->error, "", {}) + flags(tags->invalid_where, "  ");
  if (const auto& flow = map.optical_flow)
    text += "optical_flow:\n  camera: " + written_name(flow->camera) + "\n" +
            vector_in_camera("flow", flow->flow, "rad/s", kRates) +
            column_or_number("interval", flow->interval, "s", kTimes) +
            column_or_number("sigma", flow->sigma, "rad/s", kRates) + column_or_number("tracks", flow->tracks, "", {}) +
            flags(flow->invalid_where, "  ");
  if (const auto& laser = map.laser_range)
    text += "laser_range:\n  camera: " + written_name(laser->camera) + "\n" +
            vector_in_camera("position", laser->position, "m", kLengths) +
            column_or_number("sigma", laser->sigma, "m", kLengths) + flags(laser->invalid_where, "  ");
  return text;
}

std::string thrusters(const ThrusterColumns& columns) {
  std::string text = "thrusters:\n";
  if (columns.command)
    text += "  command: {columns: " + listed(columns.command->command.columns) +
            ", neutral: " + with_unit(columns.command->neutral, "us") +
            ", full: " + with_unit(columns.command->full, "us") + "}\n";
  if (const auto& sticks = columns.sticks) {
    text += "  sticks: {frame: " + sticks->frame + ", columns: " + listed(sticks->pulses.columns) +
            ", neutral: " + with_unit(sticks->neutral, "us") + ", full: " + with_unit(sticks->full, "us");
    if (sticks->coupling != 1.0) text += ", coupling: " + number_of(sticks->coupling);
    std::string reversed;
    for (const int motor : sticks->reversed) reversed += (reversed.empty() ? "" : ", ") + std::to_string(motor);
    text += (reversed.empty() ? "" : ", reversed: [" + reversed + "]") + std::string{"}\n"};
  }
  if (columns.inputs) {
    text += "  inputs: {columns: " + listed(columns.inputs->group.columns) + ", units: [";
    for (std::size_t i = 0; i < columns.inputs->units.size(); ++i)
      text += (i == 0 ? "" : ", ") + columns.inputs->units[i];
    text += "]}\n";
  }
  if (columns.speed)
    text += "  speed: {columns: " + listed(columns.speed->speed.columns) +
            ", unit: " + unit_of(columns.speed->speed.factor, "rad/s", kRates) +
            ", ahead: " + with_unit(columns.speed->ahead, "N/(rad/s)^2") +
            ", astern: " + with_unit(columns.speed->astern, "N/(rad/s)^2") + "}\n";
  if (columns.pwm)
    text += "  pwm: {columns: " + listed(columns.pwm->columns) +
            ", unit: " + unit_of(columns.pwm->factor, "us", {"ms", "s"}) + "}\n";
  if (columns.force)
    text += "  force: {columns: " + listed(columns.force->columns) +
            ", unit: " + unit_of(columns.force->factor, "N", kForces) + "}\n";
  if (columns.wrench_force) {
    std::vector<Column> all = columns.wrench_force->columns;
    if (columns.wrench_moment)
      all.insert(all.end(), columns.wrench_moment->columns.begin(), columns.wrench_moment->columns.end());
    text += "  wrench: {columns: " + listed(all) +
            ", force_unit: " + unit_of(columns.wrench_force->factor, "N", kForces) +
            ", moment_unit: " + unit_of(columns.wrench_moment ? columns.wrench_moment->factor : 1.0, "N m", {}) +
            ", frame: " + body_of(columns.wrench_force->to_house) + "}\n";
  }
  return text + flags(columns.invalid_where, "  ");
}

std::string signals(const SignalColumns& signals) {
  std::vector<Column> columns;
  std::string units, quantities;
  bool any = false;
  for (const SignalColumn& one : signals.columns) {
    columns.push_back(one.group.columns.front());
    units += (units.empty() ? "" : ", ") + written_name(one.written);
    quantities += (quantities.empty() ? "" : ", ") + (one.quantity.empty() ? std::string{"none"} : one.quantity);
    any = any || !one.quantity.empty();
  }
  return "signals:\n  columns: " + listed(columns) + "\n  units: [" + units + "]\n" +
         (any ? "  quantities: [" + quantities + "]\n" : "") + flags(signals.invalid_where, "  ");
}

std::string wind(const SignalColumns& wind) {
  const bool apparent = wind.columns.front().quantity.ends_with("_apparent");
  std::string text = std::string{"wind:\n  reference: "} + (apparent ? "apparent" : "true") + "\n";
  for (const SignalColumn& one : wind.columns)
    text += std::string{one.unit == "rad" ? "  from" : "  speed"} +
            ": {column: " + written_name(one.group.columns.front().name) + ", unit: " + written_name(one.written) +
            "}\n";
  return text + flags(wind.invalid_where, "  ");
}

}  // namespace

std::string written_name(const std::string& name) {
  const bool plain = !name.empty() && std::ranges::all_of(name, [](unsigned char c) {
    return std::isalnum(c) != 0 || c == '_' || c == '.' || c == '/';
  });
  if (plain) return name;
  std::string text = "'";
  for (const char c : name) text += c == '\'' ? std::string{"''"} : std::string{c};
  return text + "'";
}

std::string to_yaml(const ColumnMap& map) {
  std::string text = "source: " + written_name(map.source.empty() ? "not stated" : map.source) +
                     "\nlicence: " + written_name(map.licence.empty() ? "not stated" : map.licence) + "\n";
  if (map.time.columns.size() > 1) {
    text += "time: {columns: " + listed(map.time.columns) + ", units: [";
    for (std::size_t i = 0; i < map.time_factors.size(); ++i)
      text += (i > 0 ? ", " : "") + unit_of(map.time_factors[i], "s", kTimes);
    text += "]}\n";
  } else {
    ColumnGroup time = map.time;
    if (!map.time_factors.empty()) time.factor = map.time_factors.front();
    text += "time: " + scalar(time, "s", kTimes) + "\n";
  }
  if (map.pose_capture) {
    text += "pose_capture:\n";
    if (map.pose_capture->position && map.pose_capture->geodetic) {
      text += "  geodetic: {columns: " + listed(map.pose_capture->position->columns) +
              ", unit: " + unit_of(map.pose_capture->position->factor, "rad", kAngles) + "}\n";
    } else if (map.pose_capture->position) {
      const ColumnGroup& position = *map.pose_capture->position;
      text += "  position: " + vector(position, world_of(position.to_house), "m", kLengths) + "\n";
    }
    if (map.pose_capture->attitude) text += attitude(*map.pose_capture->attitude, "  ");
    text += held(map.pose_capture->held, "  ") + flags(map.pose_capture->invalid_where, "  ");
  }
  if (map.ahrs) {
    text += "ahrs:\n";
    if (map.ahrs->rates) {
      const ColumnGroup& rates = *map.ahrs->rates;
      const std::string frame = map.ahrs->euler_rates      ? "euler"
                                : map.ahrs->rates_in_world ? world_of(rates.to_house)
                                                           : body_of(rates.to_house);
      text += "  rates: " + vector(rates, frame, "rad/s", kRates) + "\n";
    }
    if (map.ahrs->specific_force) {
      const ColumnGroup& force = *map.ahrs->specific_force;
      text += "  specific_force: " + vector(force, body_of(force.to_house), "m/s^2", {"mm/s^2", "cm/s^2"}) + "\n";
    }
    if (map.ahrs->attitude) text += attitude(*map.ahrs->attitude, "  ");
    text += flags(map.ahrs->invalid_where, "  ");
  }
  if (map.dvl) {
    text += "dvl:\n";
    const ColumnGroup& velocity = map.dvl->velocity;
    if (map.dvl->course_factor != 0.0) {
      ColumnGroup course{{velocity.columns[0]}, map.dvl->course_factor}, speed{{velocity.columns[1]}, velocity.factor};
      text += "  course: " + scalar(course, "rad", kAngles) + "\n  speed: " + scalar(speed, "m/s", kSpeeds) + "\n";
    } else {
      const std::string frame = map.dvl->in_world ? world_of(velocity.to_house) : body_of(velocity.to_house);
      text += "  velocity: " + vector(velocity, frame, "m/s", kSpeeds) + "\n";
    }
    if (map.dvl->altitude) text += "  altitude: " + scalar(*map.dvl->altitude, "m", kLengths) + "\n";
    text += held(map.dvl->held, "  ") + flags(map.dvl->invalid_where, "  ");
  }
  if (map.depth) text += depth(*map.depth);
  if (map.thrusters) text += thrusters(*map.thrusters);
  if (map.battery) text += battery(*map.battery);
  if (map.usbl) text += usbl(*map.usbl);
  if (map.ranges) text += list("ranges", *map.ranges, "m", kLengths);
  if (map.loads) text += list("loads", *map.loads, "N", kForces);
  text += cameras(map);
  if (map.wind) text += wind(*map.wind);
  if (map.signals) text += signals(*map.signals);
  return text;
}

}  // namespace fathom::tables
