#include "common/tables/import.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <optional>
#include <set>
#include <span>

#include "common/base/error.hpp"
#include "common/base/spatial.hpp"

namespace fathom::tables {
namespace {

constexpr double kMaxSeconds = 9e9;      // beyond, a double no longer resolves a microsecond
constexpr double kNormTolerance = 0.01;  // a quaternion interpolated across a sign flip is shorter than this
constexpr double kSmallestNorm = 1e-3;   // below, the direction of a quaternion means nothing
constexpr double kGapPeriods = 5.0;      // a step of this many median periods is reported as a gap

using ColumnData = const std::vector<double>*;

std::string joined(const std::vector<std::string>& words) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : ", ") + word;
  return text;
}

std::string in_seconds(double seconds) {
  std::string text = std::to_string(std::round(seconds * 1e3) * 1e-3);
  return text.substr(0, text.size() - 3) + " s";
}

// Finds columns once, remembers which were used, and complains in the words of the map.
class Resolver {
 public:
  explicit Resolver(const CsvTable& table) : table_(table) {}

  ColumnData operator()(const Column& column) {
    const std::string where = column.where.empty() ? "" : column.where + ": ";
    ColumnData data = table_.find(column.name);
    if (data == nullptr) {
      throw InputError(where + "column '" + column.name + "' is not in " + table_.path +
                       ", which has: " + joined(table_.names));
    }
    if (used_.insert(column.name).second &&
        std::none_of(data->begin(), data->end(), [](double x) { return std::isfinite(x); })) {
      throw InputError(table_.path + ": column '" + column.name + "' holds no number at all");
    }
    return data;
  }

  std::vector<ColumnData> operator()(const std::vector<Column>& columns) {
    std::vector<ColumnData> data;
    for (const Column& column : columns) data.push_back((*this)(column));
    return data;
  }

  [[nodiscard]] std::vector<std::string> unused() const {
    std::vector<std::string> names;
    for (const std::string& name : table_.names) {
      if (!used_.contains(name)) names.push_back(name);
    }
    return names;
  }

 private:
  const CsvTable& table_;
  std::set<std::string> used_;
};

// A group of columns, ready to be read row by row.
class Group {
 public:
  Group(Resolver& resolve, const ColumnGroup& group)
      : data_(resolve(group.columns)), factor_(group.factor), to_house_(group.to_house) {}

  [[nodiscard]] bool complete(std::size_t row) const {
    return std::all_of(data_.begin(), data_.end(), [&](ColumnData column) { return std::isfinite((*column)[row]); });
  }
  [[nodiscard]] bool repeats(std::size_t row, std::size_t before) const {
    return std::all_of(data_.begin(), data_.end(),
                       [&](ColumnData column) { return (*column)[row] == (*column)[before]; });
  }
  [[nodiscard]] std::size_t size() const { return data_.size(); }
  [[nodiscard]] double raw(std::size_t i, std::size_t row) const { return (*data_[i])[row]; }
  [[nodiscard]] double scalar(std::size_t row) const { return factor_ * raw(0, row); }
  [[nodiscard]] Eigen::Vector3d vector(std::size_t row) const {
    return factor_ * (to_house_ * Eigen::Vector3d(raw(0, row), raw(1, row), raw(2, row)));
  }
  [[nodiscard]] std::vector<double> values(std::size_t row) const {
    std::vector<double> numbers(data_.size());
    for (std::size_t i = 0; i < numbers.size(); ++i) numbers[i] = factor_ * raw(i, row);
    return numbers;
  }

 private:
  std::vector<ColumnData> data_;
  double factor_;
  Eigen::Matrix3d to_house_;
};

std::optional<Group> optional_group(Resolver& resolve, const std::optional<ColumnGroup>& group) {
  return group ? std::optional<Group>(Group(resolve, *group)) : std::nullopt;
}

class AttitudeReader {
 public:
  AttitudeReader(Resolver& resolve, const AttitudeColumns& columns)
      : group(resolve, columns.group),
        euler_(columns.euler),
        factor_(columns.group.factor),
        world_(columns.world_to_house),
        body_(columns.body_to_house) {}

  /// Attitude of B in W; `unit` becomes false where the quaternion in the file is not of unit length.
  [[nodiscard]] Eigen::Quaterniond read(std::size_t row, bool& unit) const {
    if (euler_) {
      const Eigen::Vector3d angles(group.raw(0, row), group.raw(1, row), group.raw(2, row));
      return Eigen::Quaterniond(world_ * rotation_from_euler(factor_ * angles) * body_.toRotationMatrix().transpose());
    }
    Eigen::Quaterniond q(group.raw(0, row), group.raw(1, row), group.raw(2, row), group.raw(3, row));
    const double norm = q.norm();
    unit = std::abs(norm - 1.0) <= kNormTolerance;
    if (norm < kSmallestNorm) return Eigen::Quaterniond::Identity();
    q.coeffs() /= norm;
    return (world_ * q * body_.conjugate()).normalized();
  }

  Group group;

 private:
  bool euler_;
  double factor_;
  Eigen::Quaterniond world_;
  Eigen::Quaterniond body_;
};

std::optional<AttitudeReader> optional_attitude(Resolver& resolve, const std::optional<AttitudeColumns>& columns) {
  return columns ? std::optional<AttitudeReader>(AttitudeReader(resolve, *columns)) : std::nullopt;
}

class Flags {
 public:
  Flags(Resolver& resolve, const std::vector<Column>& columns) : data_(resolve(columns)) {}
  /// True when any flag is set, or cannot be read.
  [[nodiscard]] bool set(std::size_t row) const {
    return std::any_of(data_.begin(), data_.end(), [&](ColumnData column) { return (*column)[row] != 0.0; });
  }

 private:
  std::vector<ColumnData> data_;
};

struct Rows {
  std::vector<std::size_t> index;
  std::vector<Utime> utime;
};

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

Rows read_time(const CsvTable& table, const Group& time, std::vector<std::string>& notes) {
  Rows rows;
  std::size_t missing = 0;
  std::size_t falling = 0;
  std::size_t first_falling = 0;
  for (std::size_t row = 0; row < table.rows(); ++row) {
    const double seconds = time.scalar(row);
    if (!std::isfinite(seconds)) {
      ++missing;
      continue;
    }
    if (std::abs(seconds) > kMaxSeconds) {
      throw InputError(table.where(row) + ": time " + std::to_string(seconds) + " s is too large; is its unit right?");
    }
    const Utime utime = utime_after(0, seconds);
    if (!rows.utime.empty() && utime <= rows.utime.back()) {
      if (falling++ == 0) first_falling = row;
      continue;
    }
    rows.index.push_back(row);
    rows.utime.push_back(utime);
  }
  if (falling > 0 && 2 * falling >= table.rows()) {
    throw InputError(table.where(first_falling) + ": time does not rise here nor in " + std::to_string(falling - 1) +
                     " more of " + std::to_string(table.rows()) +
                     " rows; is it the time column, and is its unit right?");
  }
  if (missing > 0) notes.push_back("time: " + std::to_string(missing) + " rows dropped (empty or NaN)");
  if (falling > 0) {
    notes.push_back("time: " + std::to_string(falling) + " rows dropped because time did not rise, first at " +
                    table.where(first_falling));
  }
  if (rows.utime.size() < 3) return rows;
  std::vector<Utime> steps;
  for (std::size_t i = 1; i < rows.utime.size(); ++i) steps.push_back(rows.utime[i] - rows.utime[i - 1]);
  const auto longest = std::max_element(steps.begin(), steps.end()) - steps.begin();
  const double gap = static_cast<double>(steps[static_cast<std::size_t>(longest)]) * 1e-6;
  auto middle = steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2);
  std::nth_element(steps.begin(), middle, steps.end());
  if (gap > kGapPeriods * static_cast<double>(*middle) * 1e-6) {
    notes.push_back("time: the longest gap is " + in_seconds(gap) + ", after " +
                    in_seconds(seconds_between(0, rows.utime[static_cast<std::size_t>(longest)])));
  }
  return rows;
}

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

// Tells whether a row repeats the one before it, by flag or by comparing.
class HeldReader {
 public:
  HeldReader(Resolver& resolve, const HeldRule& rule)
      : flags_(resolve, rule.flag ? std::vector<Column>{*rule.flag} : std::vector<Column>{}), detect_(rule.detect) {}

  bool held(std::size_t row, const std::vector<const Group*>& groups) {
    const bool repeats = detect_ && before_ && std::all_of(groups.begin(), groups.end(), [&](const Group* group) {
                           return group->repeats(row, *before_);
                         });
    before_ = row;
    return repeats || flags_.set(row);
  }

 private:
  Flags flags_;
  bool detect_;
  std::optional<std::size_t> before_;
};

void import_pose(Resolver& resolve, const PoseColumns& columns, const Rows& rows, const CsvTable& table,
                 Imported& out) {
  const auto position = optional_group(resolve, columns.position);
  const auto attitude = optional_attitude(resolve, columns.attitude);
  const Flags invalid(resolve, columns.invalid_where);
  HeldReader held(resolve, columns.held);
  std::vector<const Group*> groups;
  if (position) groups.push_back(&*position);
  if (attitude) groups.push_back(&attitude->group);
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
  if (attitude) groups.push_back(&attitude->group);
  Count count{.stream = "ahrs"};
  auto& samples = out.recording.ahrs;
  samples.reserve(rows.index.size());
  each_complete(rows, groups, count, [&](std::size_t row, Utime utime) {
    if (invalid.set(row)) {
      ++count.flagged;
      return;
    }
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
  each_complete(rows, groups, count, [&](std::size_t row, Utime utime) {
    if (invalid.set(row)) {
      ++count.flagged;
      return;
    }
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
  each_complete(rows, {&group}, count, [&](std::size_t row, Utime utime) {
    if (invalid.set(row)) {
      ++count.flagged;
      return;
    }
    Sample sample;
    sample.utime = utime;
    sample.*member = group.scalar(row);
    samples.push_back(sample);
  });
  count.report(samples.size(), table, notes);
}

}  // namespace

Imported import_table(const CsvTable& table, const ColumnMap& map) {
  Imported out;
  out.recording.name = std::filesystem::path(table.path).stem().string();
  out.source = map.source;
  out.licence = map.licence;
  Resolver resolve(table);
  const Group time(resolve, map.time);
  const Rows rows = read_time(table, time, out.notes);
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

Imported import_csv(const std::string& csv_path, const std::string& map_path) {
  if (map_path.empty()) {
    const CsvTable table = read_csv(csv_path);
    return import_table(table, canonical_map(table));
  }
  const ColumnMap map = ColumnMap::load(map_path);
  return import_table(read_csv(csv_path), map);
}

}  // namespace fathom::tables
