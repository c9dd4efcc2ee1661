#include "common/excitation/preflight.hpp"

#include <algorithm>
#include <cstdio>
#include <iterator>

#include "common/base/health_words.hpp"
#include "common/base/printable.hpp"
#include "common/excitation/needs.hpp"

namespace fathom::excitation {
namespace {

constexpr double kSilence = 3.0;    // s without HEALTH, which comes each second
constexpr double kNoState = 1.0;    // s without STATE, which comes ten times a second at least
constexpr double kNoVehicle = 2.0;  // s without VEHICLE, which comes twice a second
constexpr char kSupervisor[] = "supervisor";
constexpr char kDriver[] = "thruster_driver";

std::string seconds(double time) {
  char text[32];
  std::snprintf(text, sizeof text, "%.1f s", time);
  return text;
}

/// HEALTH's detail: the reason or the figures first, counts behind them.
std::string first_words(const Health& health) { return health.detail.substr(0, health.detail.find("; ")); }

PreflightLine process_line(const PreflightInput& heard, const std::string& need) {
  const std::vector<std::string> names = alternatives(need);
  const auto spoke =
      std::find_if(names.begin(), names.end(), [&](const std::string& name) { return heard.health.contains(name); });
  if (spoke == names.end()) return {names.front(), false, "no HEALTH heard: start it"};
  const auto& [health, age] = heard.health.at(*spoke);
  if (age > kSilence) return {*spoke, false, "silent: no HEALTH for " + seconds(age) + "; start it"};
  const bool stands_in = spoke != names.begin();  // what it says of its own condition stops nothing
  const bool ended = health.state == "stopped" || health.state == "fault";
  const bool ok = health.state == "running" || (stands_in && !ended);
  const std::string words = first_words(health);
  return {*spoke, ok || words == kNotArmedYet, health.state + (words.empty() ? "" : ": " + words)};
}

PreflightLine place_line(const std::optional<Answer>& place) {
  if (!place) return {kPlace, false, "not known: the supervisor did not answer (has it this key?)"};
  return {kPlace, place->done, place->done ? place->text : place->text + remedy_of(place->text)};
}

}  // namespace

std::string remedy_of(const std::string& refusal) {
  const auto says = [&](const char* words) { return refusal.find(words) != std::string::npos; };
  if (says("tilted too far")) return "; set it upright, then arm again";
  if (says("too far ")) return "; bring it inside the room, by hand or by its own ground station, then arm again";
  if (says("the state is not valid")) return "; 'fathom status' says what the estimator hears";
  return {};
}

const std::vector<std::string>& usual_needs() {
  static const std::vector<std::string> kNeeds{"estimator", "identifier", "thruster_driver or simulator",
                                               "recorder or simulator"};
  return kNeeds;
}

std::vector<PreflightLine> preflight(const PreflightInput& heard, const std::vector<std::string>& needs) {
  std::vector<PreflightLine> lines;
  for (const std::string& need : needs) lines.push_back(process_line(heard, need));
  lines.push_back(process_line(heard, kSupervisor));
  const bool judged = lines.back().ok;
  if (!heard.state || heard.state->age > kNoState) {
    lines.push_back({"state", false, "no STATE: is the attitude sensor's driver running?"});
  } else if (!heard.state->sample.valid) {
    lines.push_back({"state", false, "not valid: what it needs is missing or too old; see HEALTH of the estimator"});
  } else {
    lines.push_back({"state", true, "valid"});
  }
  if (judged) lines.push_back(place_line(heard.place));
  std::ranges::move(vehicle_lines(heard), std::back_inserter(lines));
  return lines;
}

std::vector<PreflightLine> vehicle_lines(const PreflightInput& heard) {
  if (!heard.health.contains(kDriver) && !heard.vehicle) return {};  // a simulator has no vehicle behind it
  if (!heard.vehicle || heard.vehicle->age > kNoVehicle)
    return {{"vehicle", false, "no VEHICLE: is the thruster driver running?"}};
  std::vector<PreflightLine> lines;
  for (const ConditionLine& line : heard.vehicle->sample.lines) lines.push_back({line.name, line.ok, line.text});
  return lines;
}

bool all_ok(const std::vector<PreflightLine>& lines) {
  return std::all_of(lines.begin(), lines.end(), [](const PreflightLine& line) { return line.ok; });
}

std::string shown(const PreflightLine& line) {
  const std::string gap(line.name.size() < 16 ? 16 - line.name.size() : 1, ' ');
  return (line.ok ? "ok      " : "NOT OK  ") + printable(line.name) + gap + printable(line.text);
}

}  // namespace fathom::excitation
