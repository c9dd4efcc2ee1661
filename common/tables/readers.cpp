#include "common/tables/readers.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "common/base/error.hpp"
#include "common/base/spatial.hpp"

namespace fathom::tables {
namespace {

constexpr double kNormTolerance = 0.01;  // a quaternion interpolated across a sign flip is shorter than this
constexpr double kSmallestNorm = 1e-3;   // below, the direction of a quaternion means nothing

}  // namespace

std::string joined(const std::vector<std::string>& words) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : ", ") + word;
  return text;
}

ColumnData Resolver::operator()(const Column& column) {
  if (column.absent) return nullptr;
  const ColumnData data = table_.find(column.name);
  if (data != nullptr) {
    const std::string& fault = table_.faults[table_.index(data)];
    if (!fault.empty()) throw InputError(fault);
  } else {
    throw InputError((column.where.empty() ? "" : column.where + ": ") + "column '" + column.name + "' is not in " +
                     table_.path + ", which has: " + joined(table_.names));
  }
  const auto finite = [](double value) { return std::isfinite(value); };
  if (used_.insert(table_.names[table_.index(data)]).second && std::none_of(data->begin(), data->end(), finite)) {
    throw InputError(table_.path + ": column '" + column.name +
                     "' holds no number at all; leave out of the table what was not measured");
  }
  return data;
}

std::vector<ColumnData> Resolver::operator()(const std::vector<Column>& columns) {
  std::vector<ColumnData> data;
  data.reserve(columns.size());
  for (const Column& column : columns) data.push_back((*this)(column));
  return data;
}

std::vector<std::string> Resolver::unused() const {
  std::vector<std::string> names;
  for (const std::string& name : table_.names) {
    if (!used_.contains(name)) names.push_back(name);
  }
  return names;
}

Group::Group(Resolver& resolve, const ColumnGroup& group)
    : data_(resolve(group.columns)), factor_(group.factor), to_house_(group.to_house) {}

bool Group::complete(std::size_t row) const {
  return std::all_of(data_.begin(), data_.end(),
                     [&](ColumnData column) { return column == nullptr || std::isfinite(factor_ * (*column)[row]); });
}

bool Group::empty(std::size_t row) const {
  return std::none_of(data_.begin(), data_.end(),
                      [&](ColumnData column) { return column != nullptr && std::isfinite((*column)[row]); });
}

bool Group::repeats(std::size_t row, std::size_t before) const {
  return std::all_of(data_.begin(), data_.end(),
                     [&](ColumnData column) { return column == nullptr || (*column)[row] == (*column)[before]; });
}

Eigen::Vector3d Group::vector(std::size_t row) const {
  return factor_ * (to_house_ * Eigen::Vector3d(raw(0, row), raw(1, row), raw(2, row)));
}

std::vector<double> Group::values(std::size_t row) const {
  std::vector<double> numbers(data_.size());
  for (std::size_t i = 0; i < numbers.size(); ++i) numbers[i] = factor_ * raw(i, row);
  return numbers;
}

AttitudeReader::AttitudeReader(Resolver& resolve, const AttitudeColumns& columns)
    : group_(resolve, columns.group),
      euler_(columns.euler),
      factor_(columns.group.factor),
      world_(columns.world_to_house),
      body_(columns.body_to_house),
      heading_sign_(columns.heading_sign),
      heading_offset_(columns.heading_offset),
      world_to_body_(columns.world_to_body) {}

Eigen::Quaterniond AttitudeReader::read(std::size_t row, bool& unit) const {
  unit = true;
  Eigen::Quaterniond q;
  if (euler_) {
    q = rotation_from_euler(factor_ * Eigen::Vector3d(group_.raw(0, row), group_.raw(1, row), group_.raw(2, row)));
  } else {
    q = Eigen::Quaterniond(group_.raw(0, row), group_.raw(1, row), group_.raw(2, row), group_.raw(3, row));
    const double norm = q.norm();
    unit = std::abs(norm - 1.0) <= kNormTolerance;
    if (!(norm > kSmallestNorm && std::isfinite(norm))) return Eigen::Quaterniond::Identity();
  }
  if (world_to_body_) q = q.conjugate();
  q = (world_ * q * body_.conjugate()).normalized();
  if (heading_sign_ < 0.0) {
    Eigen::Vector3d angles = euler_from_rotation(q.toRotationMatrix());
    angles.z() = -angles.z();
    q = Eigen::Quaterniond(rotation_from_euler(angles));
  }
  if (heading_offset_ != 0.0) q = Eigen::AngleAxisd(heading_offset_, Eigen::Vector3d::UnitZ()) * q;
  return q;
}

bool Flags::set(std::size_t row) const {
  for (std::size_t i = 0; i < data_.size(); ++i) {
    const double flag = (*data_[i])[row];
    if (std::isnan(flag) || (flag == 0.0) == columns_[i].negated) return true;
  }
  return false;
}

HeldReader::HeldReader(Resolver& resolve, const HeldRule& rule)
    : flags_(resolve, rule.flag ? std::vector<Column>{*rule.flag} : std::vector<Column>{}), detect_(rule.detect) {}

bool HeldReader::held(std::size_t row, const std::vector<const Group*>& groups) {
  const bool repeats = detect_ && before_ && std::all_of(groups.begin(), groups.end(), [&](const Group* group) {
                         return group->repeats(row, *before_);
                       });
  before_ = row;
  return repeats || flags_.set(row);
}

}  // namespace fathom::tables
