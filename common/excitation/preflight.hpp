// The list that an operator goes through before anything moves: what must hold, line by line.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "common/samples/commands.hpp"
#include "common/samples/estimates.hpp"
#include "common/samples/health.hpp"
#include "common/samples/vehicle_condition.hpp"

namespace fathom::excitation {

/// Whom a trial needs where the pipeline says nothing else. A simulator stands in for what only a vehicle has.
[[nodiscard]] const std::vector<std::string>& usual_needs();

/// The newest of each with its age [s] by the clock of who heard it.
template <class Sample>
struct Aged {
  Sample sample;
  double age{};
};

/// What was heard on the bus.
struct PreflightInput {
  std::map<std::string, Aged<Health>> health;  ///< by the process's name
  std::optional<Aged<StateEstimate>> state;
  std::optional<Aged<VehicleCondition>> vehicle;
  std::optional<Answer> place;  ///< the supervisor's, who was asked whether it would arm at this place
};

struct PreflightLine {
  std::string name;  ///< "recorder", "state", "armed", ...
  bool ok{true};
  std::string text;  ///< what is so; where it is not ok, with the remedy
};

/// Name of the line about where the vehicle is; there is one where a supervisor runs that can be asked.
inline constexpr char kPlace[] = "place";

/// Every condition, those that hold too, in the order of the remedies: processes, state, place, vehicle. Pure.
/// `needs` as in the supervisor's section: names, "A or B" where B stands in for A.
[[nodiscard]] std::vector<PreflightLine> preflight(const PreflightInput& heard,
                                                   const std::vector<std::string>& needs = usual_needs());
/// Those of the vehicle alone, behind the thruster driver; none of a simulator.
[[nodiscard]] std::vector<PreflightLine> vehicle_lines(const PreflightInput& heard);
/// What to do about a refusal of the supervisor whose words do not say it; empty: they do.
[[nodiscard]] std::string remedy_of(const std::string& refusal);
[[nodiscard]] bool all_ok(const std::vector<PreflightLine>& lines);
/// One line as a terminal shows it: "ok       recorder      running: ...".
[[nodiscard]] std::string shown(const PreflightLine& line);

}  // namespace fathom::excitation
