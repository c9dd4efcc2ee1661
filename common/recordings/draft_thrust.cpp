#include "common/recordings/draft_thrust.hpp"

#include <algorithm>

#include "common/recordings/column_words.hpp"
#include "common/tables/map_writer.hpp"
#include "common/tables/unit_words.hpp"

namespace fathom::recordings {
namespace {

using By = Commanded::By;
using Found = std::vector<const Column*>;

/// A wrench by its components; or what a Slocum drives itself by.
std::string forces_of(const Columns& all) {
  const Group wrench{all,
                     {{"fx", "force_x", "tau_x"},
                      {"fy", "force_y", "tau_y"},
                      {"fz", "force_z", "tau_z"},
                      {"mx", "torque_x", "moment_x", "tau_k"},
                      {"my", "torque_y", "moment_y", "tau_m"},
                      {"mz", "torque_z", "moment_z", "tau_n"}}};
  if (wrench.there() > 1)
    return "  wrench: {columns: " + wrench.list() + ", force_unit: N, moment_unit: N m, frame: FRD}\n";
  const Group glider{all, {{"m_ballast_pumped", "m_de_oil_vol"}, {"m_battpos"}}};
  if (!glider.whole()) return "";
  return "  # engine and battery, as 'fathom vehicle slocum' has them\n  inputs: {columns: " + glider.list() +
         ", units: [cc, in]}\n";
}

std::string listed(const Found& columns) {
  std::string list;
  for (const Column* one : columns) list += (list.empty() ? "" : ", ") + tables::written_name(*one->name);
  return "[" + list + "]";
}

bool is_pulses(const Column& one) {
  constexpr double kLeast = 800.0, kMost = 2200.0;  // us
  return one.count > 0 && one.least >= kLeast && one.greatest <= kMost && one.greatest > one.least;
}

/// Columns whose name says pulses and whose numbers are such, in the order of the table.
std::string pulses_of(const Columns& all) {
  Found pulses;
  for (const Column& one : all.all()) {
    const std::string name = lower_case(*one.name);
    const bool named = name.starts_with("pwm") || name.starts_with("servo") || name.starts_with("rcou") ||
                       name.starts_with("thr") || name.starts_with("motor");
    if (named && is_pulses(one)) pulses.push_back(&one);
  }
  if (pulses.empty()) return "";
  return "  # they must be the thrusters of the vehicle file, in its order\n  pwm: {columns: " + listed(pulses) +
         ", unit: us}\n";
}

/// What is measured in a unit that no command of this kind has (a current, a temperature) commands nothing.
bool may_command(const Column& column, By by) {
  if (column.unit.empty()) return true;
  const Group one{{&column}};
  const auto is = [&](const char* dimension) { return !one.unit(dimension, "").empty(); };
  switch (by) {
    case By::kShaftSpeed:
      return is("rad/s");
    case By::kAngle:
      return is("rad");
    case By::kForce:
    case By::kPulses:
      return is("N") || is("rad/s") || is("s") || is("1");
    case By::kOther:
      return true;
  }
  return false;
}

/// The column of an actuator: of its name, however it is written, or of a usual one where it is the only one of its
/// kind.
const Column* column_of(const Columns& all, const Commanded& actuator, bool alone) {
  const std::string name = lower_case(actuator.name);
  Choices choices{name, "n_" + name, name + "_n", name + "_rpm", name + "_speed", name + "_angle", name + "_command"};
  if (alone && actuator.by == By::kShaftSpeed)
    choices.insert(choices.end(), {"rpm", "n", "propeller", "prop", "revs", "rps", "shaft_speed", "propeller_speed"});
  if (alone && actuator.by == By::kAngle)
    choices.insert(choices.end(), {"rudder", "delta", "rudder_angle", "rud", "rudder_command"});
  if (const Column* exactly = all.find(choices); exactly != nullptr) return exactly;
  const std::vector<std::string> words = words_of_actuator(actuator.name);
  if (words.empty()) return nullptr;
  for (std::size_t i = 0; i < all.all().size(); ++i) {
    const Column& one = all.all()[i];
    if (all.holds_numbers(i) && may_command(one, actuator.by) &&
        words_of_actuator(tables::unit_at_end(*one.name).name) == words)
      return &one;
  }
  return nullptr;
}

/// Of a command where its column does not say; empty: nobody knows.
std::string unit_of(const Column& column, By by) {
  constexpr double kLargest = 1.6;  // rad: no rudder is laid further
  const Group one{{&column}};
  if (by == By::kShaftSpeed) return one.unit("rad/s", "rpm");
  if (by == By::kAngle) return one.unit("rad", one.largest() > kLargest ? "deg" : "rad");
  return column.unit;
}

/// Actuators of several kinds, each by its own command.
std::string inputs_of(const Found& columns, const std::vector<Commanded>& actuators, std::string& lacking) {
  std::string units;
  for (std::size_t i = 0; i < actuators.size(); ++i) {
    const std::string unit = unit_of(*columns[i], actuators[i].by);
    if (unit.empty()) lacking += (lacking.empty() ? "" : ", ") + actuators[i].name + " (its column has no unit)";
    units += (units.empty() ? "" : ", ") + unit;
  }
  return "  # signs must be those of the vehicle file\n  inputs: {columns: " + listed(columns) + ", units: [" + units +
         "]}\n";
}

/// Thrusters that the vehicle file gives as forces or by pulses: what their columns are is told by unit and range.
ThrustDraft pushed_by(const Found& columns) {
  const Group all{columns};
  if (std::ranges::all_of(columns, [](const Column* one) { return is_pulses(*one); }))
    return {"  pwm: {columns: " + listed(columns) + ", unit: us}\n", ""};
  if (const std::string unit = all.unit("N", ""); !unit.empty())
    return {"  force: {columns: " + listed(columns) + ", unit: " + unit + "}\n", ""};
  const bool shares = all.largest() <= 1.0;
  const std::string found = "# thrusters: " + listed(columns);
  if (const std::string unit = all.unit("rad/s", ""); !unit.empty())
    return {"", found + " are shaft speeds, the vehicle file has forces. With f = k n |n|:\n#   speed: {columns: " +
                    listed(columns) + ", unit: " + unit + ", ahead: ... N/(rad/s)^2, astern: ... N/(rad/s)^2}\n"};
  return {"", found + (shares ? " are shares of full thrust:\n#   command: {columns: " + listed(columns) +
                                    ", neutral: 1500 us, full: 400 us}\n"
                              : " have no unit: force (N), speed (rpm) or pwm (us)?\n")};
}

/// A column for each actuator.
ThrustDraft commands_of(const Columns& all, const std::vector<Commanded>& actuators) {
  Found columns;
  std::string lacking;
  for (const Commanded& one : actuators) {
    const Column* column = column_of(all, one, std::ranges::count(actuators, one.by, &Commanded::by) == 1);
    if (column != nullptr) columns.push_back(column);
    if (column == nullptr) lacking += (lacking.empty() ? "" : ", ") + one.name;
  }
  if (columns.empty()) return {};
  ThrustDraft draft;
  if (lacking.empty()) {
    const bool pushed = std::ranges::all_of(
        actuators, [](const Commanded& one) { return one.by == By::kForce || one.by == By::kPulses; });
    if (pushed) return pushed_by(columns);
    draft.lines = inputs_of(columns, actuators, lacking);
  }
  if (!lacking.empty()) return {"", "# thrusters, inputs: a column for " + lacking + " is to be found, with a unit\n"};
  return draft;
}

}  // namespace

ThrustDraft thrust_of(const Columns& all, const std::vector<Commanded>& actuators) {
  ThrustDraft draft = commands_of(all, actuators);
  if (draft.lines.empty()) {
    if (std::string other = pulses_of(all); !other.empty()) return {std::move(other), ""};
    if (std::string other = forces_of(all); !other.empty()) return {std::move(other), ""};
  }
  if (draft.lines.empty() && draft.remark.empty())
    draft.remark = std::string{"# thrusters: no column looks like what drives the craft"} +
                   (actuators.empty() ? "; with --vehicle those are found that are called as its actuators are\n"
                                      : "; without one no model can be fitted\n");
  return draft;
}

}  // namespace fathom::recordings
