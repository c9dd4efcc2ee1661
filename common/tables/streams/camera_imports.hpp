// Columns of what was seen in pictures to samples: tags, optical flow, laser dots.
#pragma once

#include <cmath>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "common/samples/recording.hpp"
#include "common/tables/streams/slice.hpp"

namespace fathom::tables {

/// A column, or one number for all rows.
class NumberReader {
 public:
  NumberReader(Resolver& resolve, const ColumnOrNumber& value)
      : group_{optional_group(resolve, value.group)}, number_{value.number.value_or(0.0)} {}
  [[nodiscard]] double at(std::size_t row) const { return group_ ? group_->scalar(row) : number_; }
  /// Puts its column among those that a sample needs.
  void join(std::vector<const Group*>& groups) const {
    if (group_) groups.push_back(&*group_);
  }

 private:
  std::optional<Group> group_;
  double number_;
};

/// Whole numbers as they stand in a column; nothing for another.
inline std::optional<int> whole_number(double value) {
  if (value != std::round(value) || std::abs(value) > static_cast<double>(std::numeric_limits<int>::max())) return {};
  return static_cast<int>(value);
}

class TagImport {
 public:
  TagImport(Resolver& resolve, const TagColumns& columns)
      : camera_{columns.camera},
        tag_{resolve, columns.tag},
        error_{resolve, columns.error},
        position_{resolve, columns.position},
        quaternion_{resolve, AttitudeColumns{.group = columns.quaternion}},
        invalid_{resolve, columns.invalid_where} {}

  void take(const Slice& rows, Recording& out) {
    std::vector<const Group*> groups{&position_, &quaternion_.group()};
    tag_.join(groups);
    error_.join(groups);
    each_usable(rows, groups, invalid_, count_, [&](std::size_t row, Utime utime) {
      bool unit = false;
      const Eigen::Quaterniond q_CT = quaternion_.read(row, unit);
      const std::optional<int> tag = whole_number(tag_.at(row));
      count_.not_unit += unit ? 0 : 1;
      count_.missing += unit && !tag ? 1 : 0;
      if (!unit || !tag) return;
      out.tag_pose.push_back({.utime = utime,
                              .camera = camera_,
                              .tag = *tag,
                              .p_CT = position_.vector(row),
                              .q_CT = q_CT,
                              .reprojection_error = error_.at(row)});
      ++count_.kept;
    });
  }

  void report(const CsvTable& table, std::vector<std::string>& notes) const { count_.report(table, notes); }

 private:
  std::string camera_;
  NumberReader tag_, error_;
  Group position_;
  AttitudeReader quaternion_;
  Flags invalid_;
  Count count_{.stream = "tag_pose"};
};

class FlowImport {
 public:
  FlowImport(Resolver& resolve, const FlowColumns& columns)
      : camera_{columns.camera},
        interval_{resolve, columns.interval},
        sigma_{resolve, columns.sigma},
        tracks_{resolve, columns.tracks},
        flow_{resolve, columns.flow},
        invalid_{resolve, columns.invalid_where} {}

  void take(const Slice& rows, Recording& out) {
    std::vector<const Group*> groups{&flow_};
    interval_.join(groups);
    sigma_.join(groups);
    tracks_.join(groups);
    each_usable(rows, groups, invalid_, count_, [&](std::size_t row, Utime utime) {
      out.optical_flow.push_back({.utime = utime,
                                  .camera = camera_,
                                  .interval = interval_.at(row),
                                  .flow_C = {flow_.scalar_of(0, row), flow_.scalar_of(1, row), 0.0},
                                  .covariance = OpticalFlow::only_across(sigma_.at(row)),
                                  .n_tracks = whole_number(tracks_.at(row)).value_or(0)});
      ++count_.kept;
    });
  }

  void report(const CsvTable& table, std::vector<std::string>& notes) const { count_.report(table, notes); }

 private:
  std::string camera_;
  NumberReader interval_, sigma_, tracks_;
  Group flow_;
  Flags invalid_;
  Count count_{.stream = "optical_flow"};
};

class LaserImport {
 public:
  LaserImport(Resolver& resolve, const LaserColumns& columns)
      : camera_{columns.camera},
        sigma_{resolve, columns.sigma},
        position_{resolve, columns.position},
        invalid_{resolve, columns.invalid_where} {}

  void take(const Slice& rows, Recording& out) {
    std::vector<const Group*> groups{&position_};
    sigma_.join(groups);
    each_usable(rows, groups, invalid_, count_, [&](std::size_t row, Utime utime) {
      out.laser_range.push_back(
          {.utime = utime, .camera = camera_, .p_CL = position_.vector(row), .sigma_range = sigma_.at(row)});
      ++count_.kept;
    });
  }

  void report(const CsvTable& table, std::vector<std::string>& notes) const { count_.report(table, notes); }

 private:
  std::string camera_;
  NumberReader sigma_;
  Group position_;
  Flags invalid_;
  Count count_{.stream = "laser_range"};
};

}  // namespace fathom::tables
