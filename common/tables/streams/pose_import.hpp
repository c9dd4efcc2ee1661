// Columns of position and attitude to motion capture's samples.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "common/tables/geodetic.hpp"
#include "common/tables/streams/attitudes.hpp"
#include "common/tables/streams/slice.hpp"

namespace fathom::tables {

/// Position and attitude of one row, or in rows of their own: then each position takes the attitude between its
/// neighbours, and attitudes by themselves go to the attitude sensor's stream.
class PoseImport {
 public:
  PoseImport(Resolver& resolve, const PoseColumns& columns, const Rows& rows, std::vector<std::string>& notes)
      : position_{optional_group(resolve, columns.position)},
        attitude_{optional_attitude(resolve, columns.attitude)},
        invalid_{resolve, columns.invalid_where},
        held_{resolve, columns.held},
        geodetic_{columns.geodetic} {
    std::size_t together = 0, apart = 0;
    for (const std::size_t row : rows.index) {
      if (!position_ || !attitude_) break;
      together += position_->complete(row) && attitude_->group().complete(row) ? 1 : 0;
      apart += position_->complete(row) && attitude_->group().empty(row) ? 1 : 0;
    }
    own_rows_ = apart > together;
    if (own_rows_) each_attitude(rows, [&](const Ahrs& one) { between_.keep(one.utime, one.q_WB); });
    if (!geodetic_) return;
    origin_ = GeodeticOrigin::first_of(*position_, rows);
    notes.push_back(origin_.note());
  }

  void take(const Slice& rows, Recording& out) {
    std::vector<const Group*> needed;
    if (position_) needed.push_back(&*position_);
    if (attitude_ && !own_rows_) needed.push_back(&attitude_->group());
    auto& poses = out.pose_capture;
    poses.reserve(poses.size() + rows.index.size());
    const std::size_t before = poses.size();
    each_complete(rows, needed, count_, [&](std::size_t row, Utime utime) {
      PoseCapture pose{.utime = utime, .has_position = position_.has_value(), .has_attitude = attitude_.has_value()};
      bool unit = true;
      if (position_) pose.p_WB = geodetic_ ? origin_.north_east_down(*position_, row) : position_->vector(row);
      if (attitude_ && !own_rows_) pose.q_WB = attitude_->read(row, unit);
      if (own_rows_) {
        const auto q = between_.at(utime);
        if (!q) {
          ++count_.missing;
          return;
        }
        pose.q_WB = *q;
      }
      const bool repeats = held_.held(row, needed);
      const bool flagged = invalid_.set(row);
      count_.not_unit += unit ? 0 : 1;
      count_.held += repeats ? 1 : 0;
      count_.flagged += flagged ? 1 : 0;
      pose.valid = unit && !repeats && !flagged;
      poses.push_back(pose);
    });
    count_.kept += poses.size() - before;
    if (own_rows_) each_attitude(rows, [&](const Ahrs& one) { out.ahrs.push_back(one); });
  }

  void report(const CsvTable& table, std::vector<std::string>& notes) const {
    count_.report(table, notes);
    if (!own_rows_) return;
    notes.emplace_back(
        "pose_capture: positions and attitudes stand in rows of their own: each position has the "
        "attitude between its neighbours");
  }

 private:
  template <typename SomeRows, typename Use>
  void each_attitude(const SomeRows& rows, const Use& use) const {
    for (std::size_t k = 0; k < rows.index.size(); ++k) {
      bool unit = false;
      if (!attitude_->group().complete(rows.index[k])) continue;
      const Eigen::Quaterniond q = attitude_->read(rows.index[k], unit);
      if (unit) use({.utime = rows.utime[k], .q_WB = q, .has_attitude = true});
    }
  }

  std::optional<Group> position_;
  std::optional<AttitudeReader> attitude_;
  Flags invalid_;
  HeldReader held_;
  bool geodetic_, own_rows_{};
  GeodeticOrigin origin_;
  Attitudes between_{Recording{}};
  Count count_{.stream = "pose_capture"};
};

}  // namespace fathom::tables
