// Columns of velocity to samples of a velocity log.
#pragma once

#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "common/tables/streams/attitudes.hpp"
#include "common/tables/streams/slice.hpp"

namespace fathom::tables {

class DvlImport {
 public:
  DvlImport(Resolver& resolve, const DvlColumns& columns)
      : columns_{columns},
        velocity_{resolve, columns.velocity},
        altitude_{optional_group(resolve, columns.altitude)},
        invalid_{resolve, columns.invalid_where},
        held_{resolve, columns.held} {}

  [[nodiscard]] bool turns() const { return columns_.in_world; }

  void take(const Slice& rows, Recording& out) {
    const Attitudes attitudes(columns_.in_world ? out : Recording{});
    if (columns_.in_world && attitudes.empty()) refuse_world_axes(columns_.velocity.columns, "velocity");
    auto& samples = out.dvl;
    samples.reserve(samples.size() + rows.index.size());
    const std::size_t before = samples.size();
    each_complete(rows, {&velocity_}, count_, [&](std::size_t row, Utime utime) {
      Dvl sample{.utime = utime, .v_WB_B = velocity_.vector(row)};
      if (columns_.course_factor != 0.0) {
        const double course = columns_.course_factor * velocity_.raw(0, row), speed = velocity_.scalar_of(1, row);
        sample.v_WB_B = speed * Eigen::Vector3d(std::cos(course), std::sin(course), 0.0);
      }
      if (columns_.in_world) {
        const auto q_WB = attitudes.at(utime);
        if (!q_WB) {
          ++count_.no_attitude;
          return;
        }
        sample.v_WB_B = q_WB->conjugate() * sample.v_WB_B;
      }
      if (altitude_ && altitude_->complete(row)) sample.altitude = altitude_->scalar(row);
      sample.held = held_.held(row, {&velocity_});
      sample.valid = !invalid_.set(row);
      count_.held += sample.held ? 1 : 0;
      count_.flagged += sample.valid ? 0 : 1;
      samples.push_back(sample);
    });
    count_.kept += samples.size() - before;
  }

  void report(const CsvTable& table, std::vector<std::string>& notes) const { count_.report(table, notes); }

 private:
  const DvlColumns& columns_;
  Group velocity_;
  std::optional<Group> altitude_;
  Flags invalid_;
  HeldReader held_;
  Count count_{.stream = "dvl"};
};

}  // namespace fathom::tables
