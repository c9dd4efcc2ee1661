// Columns of rates, specific force and attitude to samples of an attitude sensor.
#pragma once

#include <algorithm>
#include <iterator>
#include <optional>
#include <string>
#include <vector>

#include "common/tables/streams/attitudes.hpp"
#include "common/tables/streams/slice.hpp"

namespace fathom::tables {

/// Rates, specific force and attitude each as they come; a row with a part of one is refused.
class AhrsImport {
 public:
  AhrsImport(Resolver& resolve, const AhrsColumns& columns)
      : columns_{columns},
        rates_{optional_group(resolve, columns.rates)},
        specific_force_{optional_group(resolve, columns.specific_force)},
        attitude_{optional_attitude(resolve, columns.attitude)},
        invalid_{resolve, columns.invalid_where} {}

  [[nodiscard]] bool turns() const { return columns_.rates_in_world || columns_.euler_rates; }

  void take(const Slice& rows, Recording& out) {
    std::vector<const Group*> groups;
    if (rates_) groups.push_back(&*rates_);
    if (specific_force_) groups.push_back(&*specific_force_);
    if (attitude_) groups.push_back(&attitude_->group());
    std::vector<Ahrs> samples;
    apart_ = apart_ || !out.ahrs.empty();  // parts of it come in rows of their own
    samples.reserve(rows.index.size());
    for (std::size_t k = 0; k < rows.index.size(); ++k) {
      const std::size_t row = rows.index[k];
      const auto whole = [&](const Group* group) { return group->complete(row); };
      const auto none = [&](const Group* group) { return group->empty(row); };
      if (std::ranges::all_of(groups, none)) {
        ++count_.empty;
        continue;
      }
      if (!std::ranges::all_of(groups, [&](const Group* group) { return whole(group) || none(group); })) {
        ++count_.missing;
        continue;
      }
      if (invalid_.set(row)) {
        ++count_.flagged;
        continue;
      }
      Ahrs sample{.utime = rows.utime[k],
                  .has_rates = rates_ && rates_->complete(row),
                  .has_specific_force = specific_force_ && specific_force_->complete(row),
                  .has_attitude = attitude_ && attitude_->group().complete(row)};
      apart_ = apart_ || !std::ranges::all_of(groups, whole);
      if (sample.has_rates) sample.w_WB_B = rates_->vector(row);
      if (sample.has_specific_force) sample.f_B = specific_force_->vector(row);
      if (sample.has_attitude) {
        bool unit = true;
        sample.q_WB = attitude_->read(row, unit);
        sample.has_attitude = unit;
        count_.not_unit += unit ? 0 : 1;
      }
      samples.push_back(sample);
    }
    if (!attitude_ && !out.ahrs.empty()) {  // attitudes of the pose that stand in rows of their own
      std::ranges::move(out.ahrs, std::back_inserter(samples));
      std::ranges::stable_sort(samples, {}, &Ahrs::utime);
    }
    out.ahrs = std::move(samples);
    if (turns()) turn_rates(out);
    count_.kept += out.ahrs.size();
  }

  void report(const CsvTable& table, std::vector<std::string>& notes) {
    if (apart_) count_.empty = 0;
    count_.report(table, notes);
  }

 private:
  void turn_rates(Recording& out) {
    const Attitudes attitudes(out);
    for (Ahrs& sample : out.ahrs) {
      if (!sample.has_rates) continue;
      const auto q_WB = attitudes.at(sample.utime);
      sample.has_rates = q_WB.has_value();
      if (q_WB) {
        sample.w_WB_B = columns_.euler_rates ? rates_from_euler(sample.w_WB_B, *q_WB)
                                             : Eigen::Vector3d(q_WB->conjugate() * sample.w_WB_B);
      }
      count_.no_attitude += q_WB ? 0 : 1;
    }
    if (attitudes.empty()) refuse_world_axes(columns_.rates->columns, "rates");
  }

  const AhrsColumns& columns_;
  std::optional<Group> rates_, specific_force_;
  std::optional<AttitudeReader> attitude_;
  Flags invalid_;
  bool apart_{};
  Count count_{.stream = "ahrs"};
};

}  // namespace fathom::tables
