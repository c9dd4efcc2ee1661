#include "common/tables/import.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <iterator>
#include <optional>

#include "common/base/error.hpp"
#include "common/base/spatial.hpp"
#include "common/tables/angle_unit.hpp"
#include "common/tables/geodetic.hpp"
#include "common/tables/header_units.hpp"
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
  std::size_t empty{};  ///< rows in which all its cells are empty: they belong to other streams, or are dropouts
  std::size_t no_attitude{};
  std::size_t flagged{};
  std::size_t held{};
  std::size_t not_unit{};

  void report(std::size_t kept, const CsvTable& table, std::vector<std::string>& notes) const {
    if (kept == 0) throw InputError(table.path + ": not one whole sample of " + stream);
    const auto say = [&](std::size_t count, const std::string& what) {
      if (count > 0) notes.push_back(stream + ": " + std::to_string(count) + " samples " + what);
    };
    if (empty > kept + missing) {
      notes.push_back(stream + ": in " + std::to_string(kept + missing) + " of " +
                      std::to_string(kept + missing + empty) + " rows, the others belong to other streams");
      say(missing, "refused (empty or NaN)");
    } else {
      say(missing + empty, "refused (empty or NaN)");
    }
    say(no_attitude, "refused: no attitude near them turns the world's axes into the body's");
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
      const bool none = std::ranges::all_of(groups, [&](const Group* group) { return group->empty(row); });
      ++(none ? count.empty : count.missing);
    }
  }
}

/// Attitudes in the order of time, between which others lie.
class Attitudes {
 public:
  explicit Attitudes(const Recording& recording) {
    for (const PoseCapture& pose : recording.pose_capture) {
      if (pose.has_attitude && pose.valid) keep(pose.utime, pose.q_WB);
    }
    if (!q_.empty()) return;
    for (const Ahrs& ahrs : recording.ahrs) {
      if (ahrs.has_attitude) keep(ahrs.utime, ahrs.q_WB);
    }
  }
  void keep(Utime utime, const Eigen::Quaterniond& q) {
    t_.push_back(utime);
    q_.push_back(q);
  }
  [[nodiscard]] bool empty() const { return q_.empty(); }
  /// Nothing where the nearest ones are further apart than kLongest.
  [[nodiscard]] std::optional<Eigen::Quaterniond> at(Utime utime) const {
    const auto after = std::ranges::lower_bound(t_, utime);
    const auto i = static_cast<std::size_t>(after - t_.begin());
    if (after != t_.end() && *after == utime) return q_[i];
    if (after == t_.end() || i == 0) return std::nullopt;
    const double gap = seconds_between(t_[i - 1], t_[i]);
    if (gap > kLongest) return std::nullopt;
    return q_[i - 1].slerp(seconds_between(t_[i - 1], utime) / gap, q_[i]);
  }

 private:
  static constexpr double kLongest = 1.0;  // s: a craft that turns by 10 deg/s is then told within a degree or two
  std::vector<Utime> t_;
  std::vector<Eigen::Quaterniond> q_;
};

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

/// p q r of the rates of roll, pitch and yaw (Fossen 2011, eq. 2.28).
Eigen::Vector3d rates_from_euler(const Eigen::Vector3d& rates, const Eigen::Quaterniond& q_WB) {
  const Eigen::Vector3d euler = euler_from_rotation(q_WB.toRotationMatrix());
  const double roll = euler.x(), pitch = euler.y();
  return {rates.x() - std::sin(pitch) * rates.z(),
          std::cos(roll) * rates.y() + std::sin(roll) * std::cos(pitch) * rates.z(),
          -std::sin(roll) * rates.y() + std::cos(roll) * std::cos(pitch) * rates.z()};
}

[[noreturn]] void refuse_world_axes(const std::vector<Column>& columns, const std::string& what) {
  throw InputError(columns.front().where + ": the " + what +
                   " along the world's axes need an attitude to be turned into the body's; name its columns "
                   "(euler or quaternion under pose_capture or ahrs)");
}

/// Position and attitude of one row, or in rows of their own: then each position takes the attitude between its
/// neighbours, and attitudes by themselves go to the attitude sensor's stream.
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
  std::size_t together = 0, apart = 0;
  for (const std::size_t row : rows.index) {
    if (!position || !attitude) break;
    together += position->complete(row) && attitude->group().complete(row) ? 1 : 0;
    apart += position->complete(row) && attitude->group().empty(row) ? 1 : 0;
  }
  const bool own_rows = apart > together;
  Attitudes between{Recording{}};
  std::vector<Ahrs> alone;
  for (std::size_t k = 0; own_rows && k < rows.index.size(); ++k) {
    bool unit = false;
    if (!attitude->group().complete(rows.index[k])) continue;
    const Eigen::Quaterniond q = attitude->read(rows.index[k], unit);
    if (!unit) continue;
    between.keep(rows.utime[k], q);
    alone.push_back({.utime = rows.utime[k], .q_WB = q, .has_attitude = true});
  }
  const GeodeticOrigin origin = columns.geodetic ? GeodeticOrigin::first_of(*position, rows) : GeodeticOrigin{};
  if (columns.geodetic) out.notes.push_back(origin.note());
  auto& poses = out.recording.pose_capture;
  poses.reserve(rows.index.size());
  const std::vector<const Group*> needed = own_rows ? std::vector<const Group*>{&*position} : groups;
  each_complete(rows, needed, count, [&](std::size_t row, Utime utime) {
    PoseCapture pose{.utime = utime, .has_position = position.has_value(), .has_attitude = attitude.has_value()};
    bool unit = true;
    if (position) pose.p_WB = columns.geodetic ? origin.north_east_down(*position, row) : position->vector(row);
    if (attitude && !own_rows) pose.q_WB = attitude->read(row, unit);
    if (own_rows) {
      const auto q = between.at(utime);
      if (!q) {
        ++count.missing;
        return;
      }
      pose.q_WB = *q;
    }
    const bool repeats = held.held(row, needed);
    const bool flagged = invalid.set(row);
    count.not_unit += unit ? 0 : 1;
    count.held += repeats ? 1 : 0;
    count.flagged += flagged ? 1 : 0;
    pose.valid = unit && !repeats && !flagged;
    poses.push_back(pose);
  });
  count.report(poses.size(), table, out.notes);
  if (!own_rows) return;
  out.notes.emplace_back(
      "pose_capture: positions and attitudes stand in rows of their own: each position has the "
      "attitude between its neighbours");
  out.recording.ahrs = std::move(alone);
}

/// Rates, specific force and attitude each as they come; a row with a part of one is refused.
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
  std::vector<Ahrs> samples;
  bool apart = !out.recording.ahrs.empty();  // parts of it come in rows of their own
  samples.reserve(rows.index.size());
  for (std::size_t k = 0; k < rows.index.size(); ++k) {
    const std::size_t row = rows.index[k];
    const auto whole = [&](const Group* group) { return group->complete(row); };
    const auto none = [&](const Group* group) { return group->empty(row); };
    if (std::ranges::all_of(groups, none)) {
      ++count.empty;
      continue;
    }
    if (!std::ranges::all_of(groups, [&](const Group* group) { return whole(group) || none(group); })) {
      ++count.missing;
      continue;
    }
    if (invalid.set(row)) {
      ++count.flagged;
      continue;
    }
    Ahrs sample{.utime = rows.utime[k],
                .has_rates = rates && rates->complete(row),
                .has_specific_force = specific_force && specific_force->complete(row),
                .has_attitude = attitude && attitude->group().complete(row)};
    apart = apart || !std::ranges::all_of(groups, whole);
    if (sample.has_rates) sample.w_WB_B = rates->vector(row);
    if (sample.has_specific_force) sample.f_B = specific_force->vector(row);
    if (sample.has_attitude) {
      bool unit = true;
      sample.q_WB = attitude->read(row, unit);
      sample.has_attitude = unit;
      count.not_unit += unit ? 0 : 1;
    }
    samples.push_back(sample);
  }
  if (apart) count.empty = 0;
  if (!attitude && !out.recording.ahrs.empty()) {  // attitudes of the pose that stand in rows of their own
    std::ranges::move(out.recording.ahrs, std::back_inserter(samples));
    std::ranges::stable_sort(samples, {}, &Ahrs::utime);
  }
  out.recording.ahrs = std::move(samples);
  if (columns.rates_in_world || columns.euler_rates) {
    const Attitudes attitudes(out.recording);
    for (Ahrs& sample : out.recording.ahrs) {
      if (!sample.has_rates) continue;
      const auto q_WB = attitudes.at(sample.utime);
      sample.has_rates = q_WB.has_value();
      if (q_WB) {
        sample.w_WB_B = columns.euler_rates ? rates_from_euler(sample.w_WB_B, *q_WB)
                                            : Eigen::Vector3d(q_WB->conjugate() * sample.w_WB_B);
      }
      count.no_attitude += q_WB ? 0 : 1;
    }
    if (attitudes.empty()) refuse_world_axes(columns.rates->columns, "rates");
  }
  count.report(out.recording.ahrs.size(), table, out.notes);
}

void import_dvl(Resolver& resolve, const DvlColumns& columns, const Rows& rows, const CsvTable& table, Imported& out) {
  const Group velocity(resolve, columns.velocity);
  const auto altitude = optional_group(resolve, columns.altitude);
  const Flags invalid(resolve, columns.invalid_where);
  HeldReader held(resolve, columns.held);
  const Attitudes attitudes(columns.in_world ? out.recording : Recording{});
  if (columns.in_world && attitudes.empty()) refuse_world_axes(columns.velocity.columns, "velocity");
  Count count{.stream = "dvl"};
  auto& samples = out.recording.dvl;
  samples.reserve(rows.index.size());
  each_complete(rows, {&velocity}, count, [&](std::size_t row, Utime utime) {
    Dvl sample{.utime = utime, .v_WB_B = velocity.vector(row)};
    if (columns.course_factor != 0.0) {
      const double course = columns.course_factor * velocity.raw(0, row), speed = velocity.scalar_of(1, row);
      sample.v_WB_B = speed * Eigen::Vector3d(std::cos(course), std::sin(course), 0.0);
    }
    if (columns.in_world) {
      const auto q_WB = attitudes.at(utime);
      if (!q_WB) {
        ++count.no_attitude;
        return;
      }
      sample.v_WB_B = q_WB->conjugate() * sample.v_WB_B;
    }
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
    sample.*member = group.scalar(row) + column.offset;
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
  const Rows rows = read_time(table, resolve, map, out.notes);
  check_angle_unit(resolve, map, rows, table);
  if (map.pose_capture) import_pose(resolve, *map.pose_capture, rows, table, out);
  if (map.ahrs) import_ahrs(resolve, *map.ahrs, rows, table, out);
  if (map.dvl) import_dvl(resolve, *map.dvl, rows, table, out);
  if (map.thrusters) import_thrusters(resolve, *map.thrusters, rows, table, out);
  if (map.depth && map.depth->group.columns.front().name == "z" && map.depth->group.columns.front().where.empty())
    out.notes.emplace_back("'z' without 'x' and 'y' is read as the column 'depth' (m, positive down)");
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
    CsvTable table = read_csv(csv_path);
    const std::vector<std::string> notes = to_si(table);
    Imported imported = import_table(table, canonical_map(table), simulated);
    imported.notes.insert(imported.notes.begin(), notes.begin(), notes.end());
    return imported;
  }
  const ColumnMap map = ColumnMap::load(map_path);
  return import_table(read_csv(csv_path), map, simulated);
}

}  // namespace fathom::tables
