#include "common/tables/readers.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "common/base/error.hpp"
#include "common/base/spatial.hpp"

namespace fathom::tables {
namespace {

constexpr double kMaxSeconds = 9e9;      // beyond, a double no longer resolves a microsecond
constexpr double kNormTolerance = 0.01;  // a quaternion interpolated across a sign flip is shorter than this
constexpr double kSmallestNorm = 1e-3;   // below, the direction of a quaternion means nothing
constexpr double kGapPeriods = 5.0;      // a step of this many median periods is reported as a gap
constexpr double kSlowestStep = 2.0;     // s between rows: slower, hardly any vehicle's motion is seen

std::string in_seconds(double seconds) {
  const std::string text = std::to_string(std::round(seconds * 1e3) * 1e-3);
  return text.substr(0, text.size() - 3) + " s";
}

/// Refuses rows too far apart to be seconds, before anything is laid on a grid that long.
void check_step(const CsvTable& table, const ColumnGroup& time, double median_step) {
  if (median_step <= kSlowestStep) return;
  const Column& column = time.columns.front();
  std::string remedy = "is its unit right?";
  for (const auto& [unit, factor] : {std::pair{"ms", 1e-3}, {"us", 1e-6}}) {
    if (time.factor != 1.0 || factor * median_step > kSlowestStep) continue;
    remedy = std::string("is it in ") + unit + "? Say so in the map" + (column.where.empty() ? " (--map)" : "") +
             ": time: {column: " + column.name + ", unit: " + unit + "}";
    break;
  }
  throw InputError((column.where.empty() ? "" : column.where + ": ") + table.path + ": column '" + column.name +
                   "': the median step between rows is " + in_seconds(median_step) +
                   ", too slow for the motion of any vehicle; " + remedy);
}

/// Notes the longest gap; the median step, in s.
double report_longest_gap(const std::vector<Utime>& utime, std::vector<std::string>& notes) {
  if (utime.size() < 3) return 0.0;
  std::vector<Utime> steps(utime.size() - 1);
  for (std::size_t i = 0; i < steps.size(); ++i) steps[i] = utime[i + 1] - utime[i];
  const auto longest = std::max_element(steps.begin(), steps.end());
  const double gap = static_cast<double>(*longest) * 1e-6;
  const double begin = seconds_between(0, utime[static_cast<std::size_t>(longest - steps.begin())]);
  const auto middle = steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2);
  std::nth_element(steps.begin(), middle, steps.end());
  const double typical = static_cast<double>(*middle) * 1e-6;
  if (gap > kGapPeriods * typical) {
    notes.push_back("time: the longest gap is " + in_seconds(gap) + ", after " + in_seconds(begin));
  }
  return typical;
}

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
    const std::string& fault = table_.faults[static_cast<std::size_t>(data - table_.columns.data())];
    if (!fault.empty()) throw InputError(fault);
  } else {
    throw InputError((column.where.empty() ? "" : column.where + ": ") + "column '" + column.name + "' is not in " +
                     table_.path + ", which has: " + joined(table_.names));
  }
  const auto finite = [](double value) { return std::isfinite(value); };
  if (used_.insert(column.name).second && std::none_of(data->begin(), data->end(), finite)) {
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
      body_(columns.body_to_house) {}

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
  return (world_ * q * body_.conjugate()).normalized();
}

bool Flags::set(std::size_t row) const {
  return std::any_of(data_.begin(), data_.end(), [&](ColumnData column) { return (*column)[row] != 0.0; });
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

Rows read_time(const CsvTable& table, Resolver& resolve, const ColumnGroup& column, std::vector<std::string>& notes) {
  const Group time(resolve, column);
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
  const double typical = report_longest_gap(rows.utime, notes);
  if (column.columns.front().name != kOwnTime) check_step(table, column, typical);
  return rows;
}

}  // namespace fathom::tables
