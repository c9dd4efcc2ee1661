#include "common/estimation/trial_columns.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>

#include "common/base/error.hpp"
#include "common/estimation/timeline.hpp"
#include "common/estimation/wording.hpp"

namespace fathom::estimation {
namespace {

constexpr double kLeastTold = 0.5;  // of the run
constexpr double kBridged = 10.0;   // typical steps of a column, over which a straight line tells of it
constexpr std::string_view kVoltage = "voltage";

struct Column {
  std::vector<double> t;  // s
  std::vector<double> x;
  std::string unit, quantity;
};

std::string names_in(const Recording& recording) {
  std::set<std::string> names;
  for (const Signal& one : recording.signals) names.insert(one.name);
  if (!recording.battery.empty()) names.emplace(kVoltage);
  std::string all;
  for (const std::string& name : names) all += (all.empty() ? "" : ", ") + name;
  return all.empty() ? "it has none" : "it has " + all;
}

bool is_there(const Recording& recording, const std::string& name) {
  return std::ranges::find(recording.signals, name, &Signal::name) != recording.signals.end() ||
         (name == kVoltage && !recording.battery.empty());
}

Column column_of(const Recording& recording, Utime origin, const std::string& name) {
  Column column;
  const auto add = [&](Utime utime, double value) {
    const double t = seconds_between(origin, utime);
    if (!std::isfinite(value))
      throw InputError(recording.name + text(": at %.3f s the column '", t) + name +
                       "', a candidate, is no number; leave such rows out of the recording");
    if (!column.t.empty() && t <= column.t.back()) return;
    column.t.push_back(t);
    column.x.push_back(value);
  };
  for (const Signal& one : recording.signals) {
    if (one.name != name) continue;
    add(one.utime, one.value);
    column.unit = one.unit;
    column.quantity = one.quantity;
  }
  if (!column.t.empty()) return column;
  if (name == kVoltage) {
    for (const Battery& one : recording.battery) add(one.utime, one.voltage);
    column.unit = "V";
  }
  if (column.t.empty())
    throw InputError(recording.name + ": no column '" + name + "', which is a candidate; " + names_in(recording));
  return column;
}

/// Straight lines between values, held beyond the first and last; bearings go the shorter way.
double at(const Column& column, double t, bool bearing) {
  const auto after = std::ranges::lower_bound(column.t, t) - column.t.begin();
  if (after == 0) return column.x.front();
  const auto k = static_cast<std::size_t>(after);
  if (k == column.t.size()) return column.x.back();
  double change = column.x[k] - column.x[k - 1];
  if (bearing) change = std::remainder(change, 2.0 * std::numbers::pi);
  return column.x[k - 1] + change * (t - column.t[k - 1]) / (column.t[k] - column.t[k - 1]);
}

void check_told(const Recording& recording, const Trial& trial, const std::string& name, const Column& column) {
  const double bridged = kBridged * typical_step(column.t), whole = trial.t.back() - trial.t.front();
  double told = 0.0;
  for (std::size_t k = 1; k < column.t.size(); ++k) {
    if (column.t[k] - column.t[k - 1] > bridged) continue;
    told += std::max(0.0, std::min(column.t[k], trial.t.back()) - std::max(column.t[k - 1], trial.t.front()));
  }
  if (told >= kLeastTold * whole) return;
  throw InputError(recording.name + ": the column '" + name + "', a candidate, tells of " +
                   text("%.3g s of %.3g s; at least half is needed", std::max(told, 0.0), whole));
}

double power(double x, const model::Candidate::Power& of) {
  const double base = of.size ? std::abs(x) : x;
  double product = 1.0;
  for (int k = 0; k < of.power; ++k) product *= base;
  return product;
}

}  // namespace

void add_columns(const Recording& recording, Utime origin, const model::Vehicle& vehicle, Trial& trial) {
  const std::size_t count = vehicle.candidates.size();
  if (count == 0) return;
  trial.columns.assign(trial.size(), Eigen::VectorXd::Zero(static_cast<Eigen::Index>(2 * count)));
  for (std::size_t place = 0; place < count; ++place) {
    const model::Candidate& candidate = vehicle.candidates[place];
    const auto value = static_cast<Eigen::Index>(2 * place), bearing = value + 1;
    std::string unit;
    for (Eigen::VectorXd& one : trial.columns) one[value] = 1.0;
    for (const model::Candidate::Power& one : candidate.columns) {
      const Column column = column_of(recording, origin, one.name);
      check_told(recording, trial, one.name, column);
      unit = model::times_unit(unit, model::power_of_unit(column.unit, one.power));
      for (std::size_t k = 0; k < trial.size(); ++k)
        trial.columns[k][value] *= power(at(column, trial.t[k] + 0.5 * trial.dt, false), one);
    }
    trial.column_units.push_back(unit);
    if (candidate.bearing.empty()) continue;
    const Column column = column_of(recording, origin, candidate.bearing);
    check_told(recording, trial, candidate.bearing, column);
    if (column.unit != "rad")
      throw InputError(recording.name + ": the column '" + candidate.bearing + "', a candidate's bearing, is in '" +
                       column.unit + "'; give its unit in the map (deg or rad)");
    // From where it blows becomes where it pushes, from the bow becomes from north.
    const double turned = column.quantity.starts_with("wind_from") ? std::numbers::pi : 0.0;
    const bool of_bow = column.quantity.ends_with("_apparent");
    if (of_bow && !trial.observed.attitude)
      throw InputError(recording.name + ": the column '" + candidate.bearing +
                       "', a candidate's bearing, is from the bow, and no heading was measured");
    for (std::size_t k = 0; k < trial.size(); ++k) {
      const Eigen::Matrix3d R_WB = trial.q_WB[k].toRotationMatrix();
      trial.columns[k][bearing] =
          at(column, trial.t[k] + 0.5 * trial.dt, true) + turned + (of_bow ? std::atan2(R_WB(1, 0), R_WB(0, 0)) : 0.0);
    }
  }
}

std::string missing_column(const Recording& recording, const model::Candidate& candidate) {
  for (const model::Candidate::Power& one : candidate.columns) {
    if (!is_there(recording, one.name)) return one.name;
  }
  return candidate.bearing.empty() || is_there(recording, candidate.bearing) ? "" : candidate.bearing;
}

}  // namespace fathom::estimation
