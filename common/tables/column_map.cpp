#include "common/tables/column_map.hpp"

#include <algorithm>
#include <array>

#include "common/base/config.hpp"
#include "common/base/error.hpp"
#include "common/base/units.hpp"
#include "common/tables/map_keys.hpp"
#include "common/tables/map_sections.hpp"
#include "common/tables/mapped_streams.hpp"

namespace fathom::tables {

using namespace map_keys;      // NOLINT(google-build-using-namespace)
using namespace map_sections;  // NOLINT(google-build-using-namespace)

namespace {

constexpr const char* kDateUnit = "date";  // of a time: texts

/// A velocity or rates: along body axes, or along the world's, as simulators and motion capture have them.
ColumnGroup moving_vector(const Config& config, const std::string& unit, bool& in_world) {
  ColumnGroup group = vector_of(config, unit);
  const auto world = world_axes(config.text("frame"));
  in_world = world.has_value();
  const std::string name = config.text("frame");
  if (!world && name != "FRD" && name != "FLU") {
    config.fail("frame", "'" + name +
                             "' is no frame of a vehicle's motion: FRD (forward, right, down) or FLU (forward, "
                             "left, up) along the body, NED, ENU or NWU along the world");
  }
  group.to_house = world ? *world : body_frame(config, "frame");
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
    attitude.group.columns = quaternion_columns(section);
  }
  if (euler && section.has("heading")) {
    const std::string sense = section.text("heading");
    if (sense != "north" && sense != "from_east" && sense != "anticlockwise") {
      section.fail("heading", "'" + sense +
                                  "' is no way to count a heading: north (clockwise from it), from_east "
                                  "(anticlockwise) or anticlockwise (from north)");
    }
    attitude.heading_sign = sense == "north" ? 1.0 : -1.0;
    attitude.heading_offset = sense == "from_east" ? 90.0 * kDegree : 0.0;
  }
  if (section.has("heading_offset")) attitude.heading_offset += section.quantity("heading_offset", "rad");
  if (!euler && section.has("turns")) {
    const std::string turns = section.text("turns");
    if (turns != "body_to_world" && turns != "world_to_body")
      section.fail("turns", "'turns' must be body_to_world or world_to_body, not '" + turns + "'");
    attitude.world_to_body = turns == "world_to_body";
  }
  attitude.world_to_house = world_frame(section, "world");
  attitude.body_to_house = body_frame(section, "body");
  return attitude;
}

/// Latitude, longitude and, if there is one, height.
ColumnGroup geodetic_of(const Config& config) {
  ColumnGroup group;
  group.columns = columns_of(config, "columns");
  if (group.columns.size() == 2) group.columns.push_back({"", config.where("columns"), true});
  need_count(config, "columns", group.columns, 3);
  if (group.columns[2].name == kNone) group.columns[2].absent = true;
  group.factor = factor_to(config, "unit", "rad");
  return group;
}

DvlColumns course_and_speed(const Config& course, const Config& speed) {
  DvlColumns dvl;
  dvl.velocity.columns = {{course.text("column"), course.where("column")},
                          {speed.text("column"), speed.where("column")},
                          {"", course.where("column"), true}};
  dvl.course_factor = factor_to(course, "unit", "rad");
  dvl.velocity.factor = factor_to(speed, "unit", "m/s");
  dvl.in_world = true;
  return dvl;
}

void read_time_of(const Config& time, ColumnMap& map) {
  if (!time.has("columns")) {
    map.time = {{{time.text("column"), time.where("column")}}, 1.0};
    map.time_factors = {time.text("unit") == kDateUnit ? 1.0 : factor_to(time, "unit", "s")};
    return;
  }
  map.time.columns = columns_of(time, "columns");
  const std::vector<std::string> units = time.texts("units");
  if (units.size() != map.time.columns.size())
    time.fail("units", "'units' needs one unit for each of 'columns', [s, ns] for example");
  for (const std::string& unit : units) {
    try {
      map.time_factors.push_back(unit == kDateUnit ? 1.0 : unit_factor(unit, "s"));
    } catch (const InputError& error) {
      time.fail("units", error.what());
    }
  }
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

constexpr std::array kStreams{"pose_capture", "ahrs",  "dvl",      "depth",        "thrusters",   "battery", "usbl",
                              "ranges",       "loads", "tag_pose", "optical_flow", "laser_range", "wind",    "signals"};

PoseColumns pose_of(const Config& section) {
  PoseColumns pose;
  if (section.has("position")) {
    const Config position = section.section("position");
    pose.position = vector_of(position, "m");
    pose.position->to_house = world_frame(position, "frame");
  } else if (section.has("geodetic")) {
    pose.position = geodetic_of(section.section("geodetic"));
    pose.geodetic = true;
  }
  pose.attitude = attitude_of(section);
  if (!pose.position && !pose.attitude)
    section.fail("", "'pose_capture' needs position, geodetic, quaternion or euler");
  pose.held = held_of(section);
  pose.invalid_where = invalid_of(section);
  return pose;
}

AhrsColumns ahrs_of(const Config& section) {
  AhrsColumns ahrs;
  if (section.has("rates")) {
    const Config rates = section.section("rates");
    ahrs.euler_rates = rates.text("frame") == "euler";
    ahrs.rates = ahrs.euler_rates ? vector_of(rates, "rad/s") : moving_vector(rates, "rad/s", ahrs.rates_in_world);
  }
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
  return ahrs;
}

DvlColumns dvl_of(const Config& section) {
  DvlColumns dvl;
  if (section.has("course")) {
    dvl = course_and_speed(section.section("course"), section.section("speed"));
  } else {
    dvl.velocity = moving_vector(section.section("velocity"), "m/s", dvl.in_world);
  }
  if (section.has("altitude")) dvl.altitude = scalar(section.section("altitude"), "m");
  dvl.held = held_of(section);
  dvl.invalid_where = invalid_of(section);
  return dvl;
}

/// z = (p - surface) / (density g).
ScalarColumn depth_by_pressure(const Config& section) {
  constexpr double kGravity = 9.80665;  // m/s^2
  const Config pressure = section.section("pressure");
  ScalarColumn depth{scalar(pressure, "Pa"), invalid_of(section)};
  const double weight = kGravity * pressure.positive("density", "kg/m^3");
  depth.weight = weight;
  depth.group.factor /= weight;
  depth.offset = -pressure.not_negative("surface", "Pa") / weight;
  return depth;
}

ScalarColumn depth_of(const Config& section) {
  if (section.has("pressure")) return depth_by_pressure(section);
  ScalarColumn depth{scalar(section, "m"), invalid_of(section)};
  const std::string direction = section.text("direction");
  if (direction != "down" && direction != "up") section.fail("direction", "'direction' must be down or up");
  if (direction == "up") depth.group.factor *= -1.0;
  return depth;
}

void read_stream(ColumnMap& map, const std::string& name, const Config& section) {
  if (name == "pose_capture") map.pose_capture = pose_of(section);
  if (name == "ahrs") map.ahrs = ahrs_of(section);
  if (name == "dvl") map.dvl = dvl_of(section);
  if (name == "depth") map.depth = depth_of(section);
  if (name == "thrusters") map.thrusters = thrusters_of(section);
  if (name == "battery") map.battery = ScalarColumn{scalar(section, "V"), invalid_of(section)};
  if (name == "usbl") map.usbl = usbl_of(section);
  if (name == "ranges") map.ranges = ListColumns{group_of(section, "m"), invalid_of(section)};
  if (name == "loads") map.loads = ListColumns{group_of(section, "N"), invalid_of(section)};
  if (name == "tag_pose") map.tag_pose = tags_of(section);
  if (name == "optical_flow") map.optical_flow = flow_of(section);
  if (name == "laser_range") map.laser_range = laser_of(section);
  if (name == "wind") map.wind = wind_of(section);
  if (name == "signals") map.signals = signals_of(section);
}

ColumnMap read(const Config& config) {
  ColumnMap map;
  map.source = config.text("source");
  map.licence = config.text("licence");
  read_time_of(config.section("time"), map);
  for (const char* name : kStreams) {
    if (config.has(name)) read_stream(map, name, config.section(name));
  }
  config.finish();
  return map;
}

/// Every column that a section names, whatever for.
void gather(const Config& config, std::vector<std::string>& columns) {
  for (const std::string& key : config.keys()) {
    if (config.is_section(key)) {
      gather(config.section(key), columns);
    } else if (key == "column") {
      columns.push_back(config.text(key));
    } else if (key == "columns" || key == "invalid_where" || key == "valid_where") {
      for (const std::string& name : config.texts(key)) {
        if (name != kNone) columns.push_back(name);
      }
    }
  }
}

std::vector<MappedStream> read_streams(const Config& config) {
  std::vector<MappedStream> streams;
  const std::string source = config.text("source");
  const std::string licence = config.text("licence");
  std::optional<ColumnGroup> time;
  if (config.has("time")) time = scalar(config.section("time"), "s");
  for (const char* name : kStreams) {
    if (!config.has(name)) continue;
    const std::vector<Config> sections =
        config.is_section(name) ? std::vector<Config>{config.section(name)} : config.list(name);
    for (const Config& section : sections) {
      MappedStream stream{.name = name, .where = section.where(), .map = {}, .columns = {}};
      stream.map.source = source;
      stream.map.licence = licence;
      if (section.has("time")) {
        stream.map.time = scalar(section.section("time"), "s");
      } else if (time) {
        stream.map.time = *time;
        stream.columns.push_back(time->columns.front().name);
      }
      read_stream(stream.map, name, section);
      gather(section, stream.columns);
      streams.push_back(std::move(stream));
    }
  }
  config.finish();
  if (streams.empty()) config.fail("", "the map names no stream");
  return streams;
}

}  // namespace

ColumnMap ColumnMap::load(const std::string& path) { return read(Config::load(path)); }

ColumnMap ColumnMap::parse(const std::string& text, const std::string& name) { return read(Config::parse(text, name)); }

std::vector<InputColumns> inputs_of_map(const std::string& path) {
  const Config config = Config::load(path);
  std::vector<InputColumns> all;
  if (!config.has("thrusters")) return all;
  for (const Config& section :
       config.is_section("thrusters") ? std::vector<Config>{config.section("thrusters")} : config.list("thrusters")) {
    const ThrusterColumns thrusters = thrusters_of(section);
    if (thrusters.inputs) all.push_back(*thrusters.inputs);
  }
  return all;
}

std::vector<MappedStream> load_streams(const std::string& path) { return read_streams(Config::load(path)); }

std::vector<MappedStream> parse_streams(const std::string& text, const std::string& name) {
  return read_streams(Config::parse(text, name));
}

}  // namespace fathom::tables
