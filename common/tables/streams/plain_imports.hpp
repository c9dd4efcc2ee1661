// Columns of thrusters, and of one number, to samples.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "common/drafts/ardusub_mixer.hpp"
#include "common/samples/recording.hpp"
#include "common/tables/streams/slice.hpp"

namespace fathom::tables {

class ThrusterImport {
 public:
  ThrusterImport(Resolver& resolve, const ThrusterColumns& columns)
      : columns_{columns},
        pwm_{optional_group(resolve, commands_of(columns))},
        force_{optional_group(resolve, columns.speed ? std::optional{columns.speed->speed} : columns.force)},
        wrench_force_{optional_group(resolve, columns.wrench_force)},
        wrench_moment_{optional_group(resolve, columns.wrench_moment)},
        invalid_{resolve, columns.invalid_where} {
    if (const auto& sticks = columns.sticks) mixer_.emplace(sticks->frame, sticks->coupling, sticks->reversed);
  }

  void take(const Slice& rows, Recording& out) {
    std::vector<const Group*> groups;
    for (const auto* group : {&pwm_, &force_, &wrench_force_, &wrench_moment_}) {
      if (*group) groups.push_back(&**group);
    }
    auto& samples = out.thrusters;
    samples.reserve(samples.size() + rows.index.size());
    const std::size_t before = samples.size();
    each_usable(rows, groups, invalid_, count_, [&](std::size_t row, Utime utime) {
      Thrusters sample;
      sample.utime = utime;
      if (pwm_) sample.pwm_us = pwm_->values(row);
      if (const auto& inputs = columns_.inputs) {
        for (std::size_t i = 0; i < sample.pwm_us.size(); ++i) sample.pwm_us[i] *= inputs->factors[i];
      }
      if (const auto& command = columns_.command) {
        for (double& pulse : sample.pwm_us) pulse = command->neutral + command->full * pulse;
      }
      if (mixer_ && !mix(sample.pwm_us)) {
        ++count_.no_stick;
        return;
      }
      if (force_) sample.force = force_->values(row);
      if (const auto& speed = columns_.speed) {
        for (double& n : sample.force) n = (n < 0.0 ? speed->astern : speed->ahead) * n * std::abs(n);
      }
      if (wrench_force_ && wrench_moment_) {
        Eigen::Map<Eigen::Vector3d>(sample.tau.data()) = wrench_force_->vector(row);
        Eigen::Map<Eigen::Vector3d>(sample.tau.data() + 3) = wrench_moment_->vector(row);
        sample.has_tau = true;
      }
      samples.push_back(std::move(sample));
    });
    count_.kept += samples.size() - before;
  }

  void report(const CsvTable& table, std::vector<std::string>& notes) const { count_.report(table, notes); }

 private:
  /// Pulses of six sticks to those of the motors; false where a channel tells none.
  bool mix(std::vector<double>& pulses) const {
    constexpr double kMostThrow = 1.5;  // of a full stick: receivers tell 0, 65535 or less than 900 us for "no signal"
    const StickColumns& sticks = *columns_.sticks;
    std::array<double, 6> stick{};
    for (std::size_t i = 0; i < stick.size(); ++i) {
      if (sticks.pulses.columns[i].absent) continue;
      stick[i] = (pulses[i] - sticks.neutral) / sticks.full;
      if (!(std::abs(stick[i]) <= kMostThrow)) return false;
      stick[i] = std::clamp(stick[i], -1.0, 1.0);
    }
    pulses.resize(mixer_->motors());
    mixer_->mix({.roll = stick[1],
                 .pitch = stick[0],
                 .yaw = stick[3],
                 .throttle = stick[2],
                 .forward = stick[4],
                 .lateral = stick[5]},
                pulses);
    for (double& pulse : pulses) pulse = sticks.neutral + sticks.full * pulse;
    return true;
  }

  static std::optional<ColumnGroup> commands_of(const ThrusterColumns& columns) {
    if (columns.sticks) return columns.sticks->pulses;
    if (columns.inputs) return columns.inputs->group;
    return columns.command ? std::optional{columns.command->command} : columns.pwm;
  }

  const ThrusterColumns& columns_;
  std::optional<drafts::ArdusubMixer> mixer_;
  std::optional<Group> pwm_, force_, wrench_force_, wrench_moment_;
  Flags invalid_;
  Count count_{.stream = "thrusters"};
};

template <typename Sample>
class ScalarImport {
 public:
  ScalarImport(Resolver& resolve, const ScalarColumn& column, double Sample::*member, const std::string& stream)
      : group_{resolve, column.group},
        invalid_{resolve, column.invalid_where},
        offset_{column.offset},
        member_{member},
        count_{.stream = stream} {}

  void take(const Slice& rows, std::vector<Sample>& samples) {
    samples.reserve(samples.size() + rows.index.size());
    const std::size_t before = samples.size();
    each_usable(rows, {&group_}, invalid_, count_, [&](std::size_t row, Utime utime) {
      Sample sample;
      sample.utime = utime;
      sample.*member_ = group_.scalar(row) + offset_;
      samples.push_back(sample);
    });
    count_.kept += samples.size() - before;
  }

  void report(const CsvTable& table, std::vector<std::string>& notes) const { count_.report(table, notes); }

 private:
  Group group_;
  Flags invalid_;
  double offset_;
  double Sample::*member_;
  Count count_;
};

}  // namespace fathom::tables
