#include "common/recordings/draft_thrust.hpp"

#include <algorithm>

#include "common/tables/map_writer.hpp"

namespace fathom::recordings {
namespace {

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

/// Columns whose name says pulses and whose numbers are such, in the order of the table.
std::string pulses_of(const Columns& all) {
  constexpr double kLeast = 800.0, kMost = 2200.0;  // us
  std::vector<std::string> pulses;
  for (const Column& one : all.all()) {
    const std::string name = lower_case(*one.name);
    const bool named = name.starts_with("pwm") || name.starts_with("servo") || name.starts_with("rcou") ||
                       name.starts_with("thr") || name.starts_with("motor");
    if (named && one.count > 0 && one.least >= kLeast && one.greatest <= kMost && one.greatest > one.least)
      pulses.push_back(tables::written_name(*one.name));
  }
  if (pulses.empty()) return "";
  std::string list;
  for (const std::string& one : pulses) list += (list.empty() ? "" : ", ") + one;
  return "  # they must be the thrusters of the vehicle file, in its order\n  pwm: {columns: [" + list +
         "], unit: us}\n";
}

using By = Commanded::By;

/// Of a command where its column does not say; empty: nobody knows.
std::string unit_of(const Group& column, By by) {
  constexpr double kLargest = 1.6;  // rad: no rudder is laid further
  switch (by) {
    case By::kShaftSpeed:
      return column.unit("rad/s", "rpm");
    case By::kAngle:
      return column.unit("rad", column.largest() > kLargest ? "deg" : "rad");
    case By::kOther:
      return column.columns[0]->unit;
  }
  return "";
}

/// A column for each actuator: of its name, or of a usual one where it is the only one of its kind.
ThrustDraft inputs_of(const Columns& all, const std::vector<Commanded>& actuators) {
  std::string list, units, lacking;
  for (const Commanded& one : actuators) {
    const std::string name = lower_case(one.name);
    Choices choices{name, "n_" + name, name + "_n", name + "_rpm", name + "_speed", name + "_angle", name + "_command"};
    const bool alone = std::ranges::count(actuators, one.by, &Commanded::by) == 1;
    if (alone && one.by == By::kShaftSpeed)
      choices.insert(choices.end(), {"rpm", "n", "propeller", "prop", "revs", "rps"});
    if (alone && one.by == By::kAngle) choices.insert(choices.end(), {"rudder", "delta", "rudder_angle", "rud"});
    const Group group{all, {choices}};
    if (!group.whole()) {
      lacking += (lacking.empty() ? "" : ", ") + one.name;
      continue;
    }
    const std::string unit = unit_of(group, one.by);
    if (unit.empty()) {
      lacking += (lacking.empty() ? "" : ", ") + one.name + " (its column has no unit)";
      continue;
    }
    list += (list.empty() ? "" : ", ") + tables::written_name(*group.columns[0]->name);
    units += (units.empty() ? "" : ", ") + unit;
  }
  if (list.empty()) return {};
  if (!lacking.empty()) return {"", "# thrusters, inputs: a column for " + lacking + " is to be found, with a unit\n"};
  return {"  # signs must be those of the vehicle file\n  inputs: {columns: [" + list + "], units: [" + units + "]}\n",
          ""};
}

}  // namespace

ThrustDraft thrust_of(const Columns& all, const std::vector<Commanded>& actuators) {
  ThrustDraft draft = inputs_of(all, actuators);
  if (draft.lines.empty()) draft.lines = pulses_of(all);
  if (draft.lines.empty()) draft.lines = forces_of(all);
  if (!draft.lines.empty()) draft.remark.clear();  // something else drives it
  return draft;
}

}  // namespace fathom::recordings
