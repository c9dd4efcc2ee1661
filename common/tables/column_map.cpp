#include "common/tables/column_map.hpp"

#include <algorithm>

#include "common/base/config.hpp"
#include "common/base/error.hpp"
#include "common/base/units.hpp"

namespace fathom::tables {
namespace {

constexpr const char* kNone = "none";  // in a list of columns: this component was not measured

double factor_to(const Config& config, const std::string& key, const std::string& unit) {
  try {
    return unit_factor(config.text(key), unit);
  } catch (const InputError& error) {
    const std::string message = error.what();
    if (message.rfind("unit '", 0) != 0 && message.rfind("the unit", 0) != 0) throw;
    config.fail(key, message);
  }
}

void need_count(const Config& config, const std::string& key, const std::vector<Column>& columns, std::size_t count) {
  if (columns.size() == count) return;
  config.fail(key, "'" + key + "' needs " + std::to_string(count) + " columns, not " + std::to_string(columns.size()));
}

std::vector<Column> columns_of(const Config& config, const std::string& key) {
  std::vector<Column> columns;
  for (const std::string& name : config.texts(key)) columns.push_back({name, config.where(key)});
  if (columns.empty()) config.fail(key, "'" + key + "' names no column");
  return columns;
}

/// Components of a group, one column each, 'none' where there is none; fewer when the vehicle file tells which.
std::vector<Column> components_of(const Config& config, const std::string& key, std::size_t count) {
  std::vector<Column> columns = columns_of(config, key);
  if (columns.size() > count) need_count(config, key, columns, count);
  for (Column& column : columns) {
    if (column.name == kNone) column = {"", column.where, true};
  }
  if (std::ranges::all_of(columns, &Column::absent)) config.fail(key, "'" + key + "' names no column");
  if (columns.size() < count && std::ranges::any_of(columns, &Column::absent)) need_count(config, key, columns, count);
  return columns;
}

Eigen::Matrix3d body_frame(const Config& config, const std::string& key) {
  const std::string name = config.text(key);
  if (name == "FRD") return Eigen::Matrix3d::Identity();
  if (name == "FLU") return Eigen::Vector3d(1.0, -1.0, -1.0).asDiagonal();
  config.fail(key, "'" + name + "' is no body frame: FRD (forward, right, down) or FLU (forward, left, up)");
}

Eigen::Matrix3d world_frame(const Config& config, const std::string& key) {
  const std::string name = config.text(key);
  if (name == "NED") return Eigen::Matrix3d::Identity();
  if (name == "NWU") return Eigen::Vector3d(1.0, -1.0, -1.0).asDiagonal();
  if (name == "ENU") return (Eigen::Matrix3d() << 0, 1, 0, 1, 0, 0, 0, 0, -1).finished();
  config.fail(key, "'" + name + "' is no world frame: NED, NWU (z up, y to the left of x) or ENU");
}

ColumnGroup group_of(const Config& config, const std::string& unit) {
  ColumnGroup group;
  group.columns = columns_of(config, "columns");
  group.factor = factor_to(config, "unit", unit);
  return group;
}

ColumnGroup vector_of(const Config& config, const std::string& unit) {
  return {components_of(config, "columns", 3), factor_to(config, "unit", unit)};
}

ColumnGroup body_vector(const Config& config, const std::string& unit) {
  ColumnGroup group = vector_of(config, unit);
  group.to_house = body_frame(config, "frame");
  return group;
}

ColumnGroup scalar(const Config& config, const std::string& unit) {
  ColumnGroup group;
  group.columns = {{config.text("column"), config.where("column")}};
  group.factor = factor_to(config, "unit", unit);
  return group;
}

// Whichever of `quaternion` and `euler` the section holds.
std::optional<AttitudeColumns> attitude_of(const Config& config) {
  const bool quaternion = config.has("quaternion");
  const bool euler = config.has("euler");
  if (quaternion && euler) config.fail("euler", "state 'quaternion' or 'euler', not both");
  if (!quaternion && !euler) return std::nullopt;
  const Config section = config.section(quaternion ? "quaternion" : "euler");
  AttitudeColumns attitude;
  attitude.euler = euler;
  if (euler) {
    attitude.group = vector_of(section, "rad");
  } else {
    std::vector<Column> columns = columns_of(section, "columns");
    need_count(section, "columns", columns, 4);
    const std::string order = section.text("order");
    if (order != "wxyz" && order != "xyzw") section.fail("order", "'order' must be wxyz or xyzw, not '" + order + "'");
    if (order == "xyzw") std::rotate(columns.begin(), columns.begin() + 3, columns.end());
    attitude.group.columns = std::move(columns);
  }
  attitude.world_to_house = world_frame(section, "world");
  attitude.body_to_house = body_frame(section, "body");
  return attitude;
}

std::vector<Column> invalid_of(const Config& config) {
  return config.has("invalid_where") ? columns_of(config, "invalid_where") : std::vector<Column>{};
}

HeldRule held_of(const Config& config) {
  HeldRule rule;
  if (!config.has("held")) return rule;
  if (config.is_section("held")) {
    const Config section = config.section("held");
    rule.flag = Column{section.text("column"), section.where("column")};
  } else if (config.text("held") == "detect") {
    rule.detect = true;
  } else {
    config.fail("held", "'held' must be 'detect' or '{column: NAME}'");
  }
  return rule;
}

ThrusterColumns thrusters_of(const Config& config) {
  ThrusterColumns thrusters;
  if (config.has("pwm")) thrusters.pwm = group_of(config.section("pwm"), "us");
  if (config.has("force")) thrusters.force = group_of(config.section("force"), "N");
  if (config.has("wrench")) {
    const Config wrench = config.section("wrench");
    const std::vector<Column> columns = components_of(wrench, "columns", 6);
    const auto split = columns.begin() + (columns.size() == 6 ? 3 : static_cast<std::ptrdiff_t>(columns.size()));
    const Eigen::Matrix3d frame = body_frame(wrench, "frame");
    thrusters.wrench_force = {{columns.begin(), split}, factor_to(wrench, "force_unit", "N"), frame};
    thrusters.wrench_moment = {{split, columns.end()}, factor_to(wrench, "moment_unit", "N m"), frame};
  }
  if (!thrusters.pwm && !thrusters.force && !thrusters.wrench_force) {
    config.fail("", "'thrusters' needs pwm, force or wrench");
  }
  thrusters.invalid_where = invalid_of(config);
  return thrusters;
}

ColumnMap read(const Config& config) {
  ColumnMap map;
  map.source = config.text("source");
  map.licence = config.text("licence");
  map.time = scalar(config.section("time"), "s");
  if (config.has("pose_capture")) {
    const Config section = config.section("pose_capture");
    PoseColumns pose;
    if (section.has("position")) {
      const Config position = section.section("position");
      pose.position = vector_of(position, "m");
      pose.position->to_house = world_frame(position, "frame");
    }
    pose.attitude = attitude_of(section);
    if (!pose.position && !pose.attitude) section.fail("", "'pose_capture' needs position, quaternion or euler");
    pose.held = held_of(section);
    pose.invalid_where = invalid_of(section);
    map.pose_capture = std::move(pose);
  }
  if (config.has("ahrs")) {
    const Config section = config.section("ahrs");
    AhrsColumns ahrs;
    if (section.has("rates")) ahrs.rates = body_vector(section.section("rates"), "rad/s");
    if (section.has("specific_force")) {
      const Config force = section.section("specific_force");
      ahrs.specific_force = body_vector(force, "m/s^2");
      need_count(force, "columns", ahrs.specific_force->columns, 3);  // gravity is felt along every axis
      if (std::ranges::any_of(ahrs.specific_force->columns, &Column::absent))
        force.fail("columns", "'columns' of a specific force cannot be 'none'");
    }
    ahrs.attitude = attitude_of(section);
    if (!ahrs.rates && !ahrs.specific_force && !ahrs.attitude) {
      section.fail("", "'ahrs' needs rates, specific_force, quaternion or euler");
    }
    ahrs.invalid_where = invalid_of(section);
    map.ahrs = std::move(ahrs);
  }
  if (config.has("dvl")) {
    const Config section = config.section("dvl");
    DvlColumns dvl;
    dvl.velocity = body_vector(section.section("velocity"), "m/s");
    if (section.has("altitude")) dvl.altitude = scalar(section.section("altitude"), "m");
    dvl.held = held_of(section);
    dvl.invalid_where = invalid_of(section);
    map.dvl = std::move(dvl);
  }
  if (config.has("depth")) {
    const Config section = config.section("depth");
    map.depth = ScalarColumn{scalar(section, "m"), invalid_of(section)};
    const std::string direction = section.text("direction");
    if (direction != "down" && direction != "up") section.fail("direction", "'direction' must be down or up");
    if (direction == "up") map.depth->group.factor *= -1.0;
  }
  if (config.has("thrusters")) map.thrusters = thrusters_of(config.section("thrusters"));
  if (config.has("battery")) {
    const Config section = config.section("battery");
    map.battery = ScalarColumn{scalar(section, "V"), invalid_of(section)};
  }
  config.finish();
  return map;
}

}  // namespace

ColumnMap ColumnMap::load(const std::string& path) { return read(Config::load(path)); }

ColumnMap ColumnMap::parse(const std::string& text, const std::string& name) { return read(Config::parse(text, name)); }

}  // namespace fathom::tables
