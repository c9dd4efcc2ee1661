// Columns of a table made readable row by row: found by name, scaled to SI, turned into the house's frames.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "common/base/time.hpp"
#include "common/tables/column_map.hpp"
#include "common/tables/csv.hpp"

namespace fathom::tables {

/// The time of a recording with topics: a clock of its own, of whose unit there is no question.
inline constexpr const char* kOwnTime = "(time)";

using ColumnData = const Paged<double>*;

/// Finds columns, remembers which were used, and complains in the words of the map.
class Resolver {
 public:
  explicit Resolver(const CsvTable& table) : table_(table) {}
  /// InputError when there is no such column, or not one number in it; nullptr for one that is marked absent.
  ColumnData operator()(const Column& column);
  std::vector<ColumnData> operator()(const std::vector<Column>& columns);
  /// Columns that nobody asked for.
  [[nodiscard]] std::vector<std::string> unused() const;

 private:
  const CsvTable& table_;
  std::set<std::string> used_;
};

/// Columns that are read together: a scalar, a vector, a row of numbers.
class Group {
 public:
  Group(Resolver& resolve, const ColumnGroup& group);
  [[nodiscard]] bool complete(std::size_t row) const;
  /// Not one number: the row belongs to other streams.
  [[nodiscard]] bool empty(std::size_t row) const;
  [[nodiscard]] bool repeats(std::size_t row, std::size_t before) const;
  [[nodiscard]] double raw(std::size_t i, std::size_t row) const {
    return data_[i] == nullptr ? 0.0 : (*data_[i])[row];
  }
  [[nodiscard]] double scalar(std::size_t row) const { return scalar_of(0, row); }
  [[nodiscard]] double scalar_of(std::size_t i, std::size_t row) const { return factor_ * raw(i, row); }
  [[nodiscard]] Eigen::Vector3d vector(std::size_t row) const;  ///< SI, in the house's frame
  [[nodiscard]] std::vector<double> values(std::size_t row) const;

 private:
  std::vector<ColumnData> data_;
  double factor_;
  Eigen::Matrix3d to_house_;
};

/// Attitude of B in W from quaternion or Euler columns.
class AttitudeReader {
 public:
  AttitudeReader(Resolver& resolve, const AttitudeColumns& columns);
  [[nodiscard]] const Group& group() const { return group_; }
  /// `unit` tells whether the quaternion in the file is of unit length.
  [[nodiscard]] Eigen::Quaterniond read(std::size_t row, bool& unit) const;

 private:
  Group group_;
  bool euler_;
  double factor_;
  Eigen::Quaterniond world_;
  Eigen::Quaterniond body_;
  double heading_sign_, heading_offset_;
  bool world_to_body_;
};

class Flags {
 public:
  Flags(Resolver& resolve, const std::vector<Column>& columns) : columns_(columns), data_(resolve(columns)) {}
  /// True when any flag is set (a negated one: is zero), or cannot be read.
  [[nodiscard]] bool set(std::size_t row) const;

 private:
  std::vector<Column> columns_;
  std::vector<ColumnData> data_;
};

/// Tells whether a row repeats the one before it, by flag or by comparing. To be asked row after row.
class HeldReader {
 public:
  HeldReader(Resolver& resolve, const HeldRule& rule);
  [[nodiscard]] bool held(std::size_t row, const std::vector<const Group*>& groups);

 private:
  Flags flags_;
  bool detect_;
  std::optional<std::size_t> before_;
};

/// Rows whose time rises, and their stamps.
struct Rows {
  Paged<std::size_t> index;
  Paged<Utime> utime;
};

/// Reads the time (time_column.cpp) and drops rows in which it does not rise, counts them and names the longest gap in
/// `notes`. InputError when rows are so far apart that the unit must be another.
[[nodiscard]] Rows read_time(const CsvTable& table, Resolver& resolve, const ColumnMap& map,
                             std::vector<std::string>& notes);

[[nodiscard]] std::string joined(const std::vector<std::string>& words);

}  // namespace fathom::tables
