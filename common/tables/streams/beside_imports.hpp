// Columns of instruments beside the usual ones to samples: acoustic fixes, ranges, loads, and whatever is carried as it
// is.
#pragma once

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "common/samples/recording.hpp"
#include "common/tables/streams/slice.hpp"

namespace fathom::tables {

class UsblImport {
 public:
  UsblImport(Resolver& resolve, const UsblColumns& columns)
      : columns_{columns},
        position_{resolve, columns.position},
        sigma_{optional_group(resolve, columns.sigma)},
        invalid_{resolve, columns.invalid_where} {}

  void take(const Slice& rows, Recording& out) {
    std::vector<const Group*> groups{&position_};
    if (sigma_) groups.push_back(&*sigma_);
    each_complete(rows, groups, count_, [&](std::size_t row, Utime utime) {
      Usbl sample{.utime = utime, .p_WB = position_.vector(row), .valid = !invalid_.set(row)};
      sample.sigma = sigma_ ? Eigen::Vector3d(sigma_->vector(row).cwiseAbs())
                            : Eigen::Vector3d(Eigen::Vector3d::Constant(columns_.stated_sigma));
      count_.flagged += sample.valid ? 0 : 1;
      ++count_.kept;
      out.usbl.push_back(sample);
    });
  }

  void report(const CsvTable& table, std::vector<std::string>& notes) const { count_.report(table, notes); }

 private:
  const UsblColumns& columns_;
  Group position_;
  std::optional<Group> sigma_;
  Flags invalid_;
  Count count_{.stream = "usbl"};
};

/// An empty cell, or zero, is no echo: the others of its row stay.
class RangesImport {
 public:
  RangesImport(Resolver& resolve, const ListColumns& columns)
      : group_{resolve, columns.group}, invalid_{resolve, columns.invalid_where} {}

  void take(const Slice& rows, Recording& out) {
    for (std::size_t k = 0; k < rows.index.size(); ++k) {
      const std::size_t row = rows.index[k];
      if (group_.empty(row)) {
        ++count_.empty;
        continue;
      }
      const bool flagged = invalid_.set(row);
      Ranges sample{.utime = rows.utime[k], .range = group_.values(row), .valid = {}};
      for (double& range : sample.range) {
        const bool heard = std::isfinite(range) && range > 0.0 && !flagged;
        sample.valid.push_back(heard ? 1 : 0);
        if (!heard) range = 0.0;
      }
      count_.flagged += flagged ? 1 : 0;
      ++count_.kept;
      out.ranges.push_back(std::move(sample));
    }
  }

  void report(const CsvTable& table, std::vector<std::string>& notes) const { count_.report(table, notes); }

 private:
  Group group_;
  Flags invalid_;
  Count count_{.stream = "ranges"};
};

class LoadsImport {
 public:
  LoadsImport(Resolver& resolve, const ListColumns& columns)
      : group_{resolve, columns.group}, invalid_{resolve, columns.invalid_where} {}

  void take(const Slice& rows, Recording& out) {
    each_usable(rows, {&group_}, invalid_, count_, [&](std::size_t row, Utime utime) {
      out.loads.push_back({.utime = utime, .load = group_.values(row)});
      ++count_.kept;
    });
  }

  void report(const CsvTable& table, std::vector<std::string>& notes) const { count_.report(table, notes); }

 private:
  Group group_;
  Flags invalid_;
  Count count_{.stream = "loads"};
};

/// Each column by itself: an empty cell is no value of this one alone.
class SignalImport {
 public:
  SignalImport(Resolver& resolve, const SignalColumns& columns) : invalid_{resolve, columns.invalid_where} {
    for (const SignalColumn& one : columns.columns)
      columns_.push_back({&one, Group{resolve, one.group}, {.stream = "column '" + name_of(one) + "'"}});
  }

  void take(const Slice& rows, Recording& out) {
    for (std::size_t k = 0; k < rows.index.size(); ++k) {
      const std::size_t row = rows.index[k];
      const bool flagged = invalid_.set(row);
      for (One& one : columns_) {
        if (!one.group.complete(row)) {
          ++one.count.empty;
        } else if (flagged) {
          ++one.count.flagged;
        } else {
          ++one.count.kept;
          out.signals.push_back({.utime = rows.utime[k],
                                 .name = name_of(*one.column),
                                 .quantity = one.column->quantity,
                                 .unit = one.column->unit,
                                 .value = one.group.scalar(row)});
        }
      }
    }
  }

  void report(const CsvTable& table, std::vector<std::string>& notes) const {
    for (const One& one : columns_) one.count.report(table, notes);
  }

 private:
  struct One {
    const SignalColumn* column;
    Group group;
    Count count;
  };
  static const std::string& name_of(const SignalColumn& one) { return one.group.columns.front().name; }

  std::vector<One> columns_;
  Flags invalid_;
};

}  // namespace fathom::tables
