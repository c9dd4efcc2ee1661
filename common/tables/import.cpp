#include "common/tables/import.hpp"

#include <algorithm>
#include <filesystem>
#include <optional>

#include "common/base/error.hpp"
#include "common/tables/angle_unit.hpp"
#include "common/tables/readers.hpp"

namespace fathom::tables {
namespace {

std::optional<Group> optional_group(Resolver& resolve, const std::optional<ColumnGroup>& group) {
  return group ? std::optional<Group>(Group(resolve, *group)) : std::nullopt;
}

std::optional<AttitudeReader> optional_attitude(Resolver& resolve, const std::optional<AttitudeColumns>& columns) {
  return columns ? std::optional<AttitudeReader>(AttitudeReader(resolve, *columns)) : std::nullopt;
}

// What happened to one stream, as sentences.
struct Count {
  std::string stream;
  std::size_t missing{};
  std::size_t flagged{};
  std::size_t held{};
  std::size_t not_unit{};

  void report(std::size_t kept, const CsvTable& table, std::vector<std::string>& notes) const {
    if (kept == 0) throw InputError(table.path + ": not one whole sample of " + stream);
    const auto say = [&](std::size_t count, const std::string& what) {
      if (count > 0) notes.push_back(stream + ": " + std::to_string(count) + " samples " + what);
    };
    say(missing, "refused (empty or NaN)");
    say(flagged, "marked or left out as invalid by their flags");
    say(held, "repeat the one before (held)");
    say(not_unit, "invalid because their quaternion is not of unit length");
  }
};

// Calls use(row, utime) for every row in which all of `groups` hold numbers; counts the others.
template <typename Use>
void each_complete(const Rows& rows, const std::vector<const Group*>& groups, Count& count, const Use& use) {
  for (std::size_t k = 0; k < rows.index.size(); ++k) {
    const std::size_t row = rows.index[k];
    if (std::all_of(groups.begin(), groups.end(), [&](const Group* group) { return group->complete(row); })) {
      use(row, rows.utime[k]);
    } else {
      ++count.missing;
    }
  }
}

// As above, and leaves out what the flags call invalid.
template <typename Use>
void each_usable(const Rows& rows, const std::vector<const Group*>& groups, const Flags& invalid, Count& count,
                 const Use& use) {
  each_complete(rows, groups, count, [&](std::size_t row, Utime utime) {
    if (invalid.set(row)) {
      ++count.flagged;
    } else {
      use(row, utime);
    }
  });
}

void import_pose(Resolver& resolve, const PoseColumns& columns, const Rows& rows, const CsvTable& table,
                 Imported& out) {
  const auto position = optional_group(resolve, columns.position);
  const auto attitude = optional_attitude(resolve, columns.attitude);
  const Flags invalid(resolve, columns.invalid_where);
  HeldReader held(resolve, columns.held);
  std::vector<const Group*> groups;
  if (position) groups.push_back(&*position);
  if (attitude) groups.push_back(&attitude->group());
  Count count{.stream = "pose_capture"};
  auto& poses = out.recording.pose_capture;
  poses.reserve(rows.index.size());
  each_complete(rows, groups, count, [&](std::size_t row, Utime utime) {
    PoseCapture pose{.utime = utime, .has_position = position.has_value(), .has_attitude = attitude.has_value()};
    bool unit = true;
    if (position) pose.p_WB = position->vector(row);
    if (attitude) pose.q_WB = attitude->read(row, unit);
    const bool repeats = held.held(row, groups);
    const bool flagged = invalid.set(row);
    count.not_unit += unit ? 0 : 1;
    count.held += repeats ? 1 : 0;
    count.flagged += flagged ? 1 : 0;
    pose.valid = unit && !repeats && !flagged;
    poses.push_back(pose);
  });
  count.report(poses.size(), table, out.notes);
}

void import_ahrs(Resolver& resolve, const AhrsColumns& columns, const Rows& rows, const CsvTable& table,
                 Imported& out) {
  const auto rates = optional_group(resolve, columns.rates);
  const auto specific_force = optional_group(resolve, columns.specific_force);
  const auto attitude = optional_attitude(resolve, columns.attitude);
  const Flags invalid(resolve, columns.invalid_where);
  std::vector<const Group*> groups;
  if (rates) groups.push_back(&*rates);
  if (specific_force) groups.push_back(&*specific_force);
  if (attitude) groups.push_back(&attitude->group());
  Count count{.stream = "ahrs"};
  auto& samples = out.recording.ahrs;
  samples.reserve(rows.index.size());
  each_usable(rows, groups, invalid, count, [&](std::size_t row, Utime utime) {
    Ahrs sample{.utime = utime,
                .has_rates = rates.has_value(),
                .has_specific_force = specific_force.has_value(),
                .has_attitude = attitude.has_value()};
    if (rates) sample.w_WB_B = rates->vector(row);
    if (specific_force) sample.f_B = specific_force->vector(row);
    if (attitude) {
      bool unit = true;
      sample.q_WB = attitude->read(row, unit);
      sample.has_attitude = unit;
      count.not_unit += unit ? 0 : 1;
    }
    samples.push_back(sample);
  });
  count.report(samples.size(), table, out.notes);
}

void import_dvl(Resolver& resolve, const DvlColumns& columns, const Rows& rows, const CsvTable& table, Imported& out) {
  const Group velocity(resolve, columns.velocity);
  const auto altitude = optional_group(resolve, columns.altitude);
  const Flags invalid(resolve, columns.invalid_where);
  HeldReader held(resolve, columns.held);
  Count count{.stream = "dvl"};
  auto& samples = out.recording.dvl;
  samples.reserve(rows.index.size());
  each_complete(rows, {&velocity}, count, [&](std::size_t row, Utime utime) {
    Dvl sample{.utime = utime, .v_WB_B = velocity.vector(row)};
    if (altitude && altitude->complete(row)) sample.altitude = altitude->scalar(row);
    sample.held = held.held(row, {&velocity});
    sample.valid = !invalid.set(row);
    count.held += sample.held ? 1 : 0;
    count.flagged += sample.valid ? 0 : 1;
    samples.push_back(sample);
  });
  count.report(samples.size(), table, out.notes);
}

void import_thrusters(Resolver& resolve, const ThrusterColumns& columns, const Rows& rows, const CsvTable& table,
                      Imported& out) {
  const auto pwm = optional_group(resolve, columns.pwm);
  const auto force = optional_group(resolve, columns.force);
  const auto wrench_force = optional_group(resolve, columns.wrench_force);
  const auto wrench_moment = optional_group(resolve, columns.wrench_moment);
  const Flags invalid(resolve, columns.invalid_where);
  std::vector<const Group*> groups;
  for (const auto* group : {&pwm, &force, &wrench_force, &wrench_moment}) {
    if (*group) groups.push_back(&**group);
  }
  Count count{.stream = "thrusters"};
  auto& samples = out.recording.thrusters;
  samples.reserve(rows.index.size());
  each_usable(rows, groups, invalid, count, [&](std::size_t row, Utime utime) {
    Thrusters sample;
    sample.utime = utime;
    if (pwm) sample.pwm_us = pwm->values(row);
    if (force) sample.force = force->values(row);
    if (wrench_force && wrench_moment) {
      Eigen::Map<Eigen::Vector3d>(sample.tau.data()) = wrench_force->vector(row);
      Eigen::Map<Eigen::Vector3d>(sample.tau.data() + 3) = wrench_moment->vector(row);
      sample.has_tau = true;
    }
    samples.push_back(std::move(sample));
  });
  count.report(samples.size(), table, out.notes);
}

template <typename Sample>
void import_scalar(Resolver& resolve, const ScalarColumn& column, double Sample::*member, const std::string& stream,
                   const Rows& rows, const CsvTable& table, std::vector<Sample>& samples,
                   std::vector<std::string>& notes) {
  const Group group(resolve, column.group);
  const Flags invalid(resolve, column.invalid_where);
  Count count{.stream = stream};
  samples.reserve(rows.index.size());
  each_usable(rows, {&group}, invalid, count, [&](std::size_t row, Utime utime) {
    Sample sample;
    sample.utime = utime;
    sample.*member = group.scalar(row);
    samples.push_back(sample);
  });
  count.report(samples.size(), table, notes);
}

}  // namespace

Imported import_table(const CsvTable& table, ColumnMap map, const std::optional<SimulatedAxes>& simulated) {
  Imported out;
  if (const std::string note = complete_groups(map, table.path, simulated); !note.empty()) out.notes.push_back(note);
  out.recording.name = std::filesystem::path(table.path).stem().string();
  out.source = map.source;
  out.licence = map.licence;
  Resolver resolve(table);
  const Rows rows = read_time(table, resolve, map.time, out.notes);
  check_angle_unit(resolve, map, rows, table);
  if (map.pose_capture) import_pose(resolve, *map.pose_capture, rows, table, out);
  if (map.ahrs) import_ahrs(resolve, *map.ahrs, rows, table, out);
  if (map.dvl) import_dvl(resolve, *map.dvl, rows, table, out);
  if (map.thrusters) import_thrusters(resolve, *map.thrusters, rows, table, out);
  if (map.depth) import_scalar(resolve, *map.depth, &Depth::z, "depth", rows, table, out.recording.depth, out.notes);
  if (map.battery) {
    import_scalar(resolve, *map.battery, &Battery::voltage, "battery", rows, table, out.recording.battery, out.notes);
  }
  if (const auto unused = resolve.unused(); !unused.empty()) out.notes.push_back("columns not used: " + joined(unused));
  return out;
}

Imported import_csv(const std::string& csv_path, const std::string& map_path,
                    const std::optional<SimulatedAxes>& simulated) {
  if (map_path.empty()) {
    const CsvTable table = read_csv(csv_path);
    return import_table(table, canonical_map(table), simulated);
  }
  const ColumnMap map = ColumnMap::load(map_path);
  return import_table(read_csv(csv_path), map, simulated);
}

}  // namespace fathom::tables
