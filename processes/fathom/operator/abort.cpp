// fathom abort: done when the vehicle says so, not when it was said.
#include <algorithm>
#include <cmath>
#include <cstdio>

#include "common/base/error.hpp"
#include "common/base/printable.hpp"
#include "processes/fathom/operator/orders.hpp"

namespace fathom::tool {
namespace {

constexpr double kWithin = 2.0;  // s in which it must be confirmed
constexpr double kAgain = 0.1;   // s between two aborts: any may be lost
constexpr double kZero = 0.1;    // N, N m: what a pulse width rounded to a microsecond may stand for
constexpr int kInARow = 3;       // of THRUSTERS, after the answer, so that none of before is counted

Utime wall_clock() {
  return std::chrono::duration_cast<std::chrono::microseconds>(std::chrono::system_clock::now().time_since_epoch())
      .count();
}

bool is_zero(const Thrusters& thrusters) {
  const auto small = [](double value) { return std::abs(value) < kZero; };
  return std::ranges::all_of(thrusters.force, small) && std::ranges::all_of(thrusters.tau, small);
}

double strongest(const Thrusters& thrusters) {
  double most = 0.0;
  for (const double each : thrusters.force) most = std::max(most, std::abs(each));
  for (const double each : thrusters.tau) most = std::max(most, std::abs(each));
  return most;
}

constexpr double kVehicle = 1.7;  // s in which VEHICLE comes, twice a second: two may be lost

constexpr char kByHand[] =
    "By hand, now: 1. the vehicle's kill switch, or its power; 2. disarm it in the ground station; 3. pull it in by "
    "the tether. Then fathom abort again, until it is confirmed.";

/// A line that leads nowhere is asked for zero like any other, and THRUSTERS says what was sent: then nobody knows what
/// the vehicle does. Empty: it reports what it applies, or is alive, or there is none (a simulator, a dry run).
std::string silence_of(const VehicleCondition& vehicle) {
  const auto heartbeat =
      std::ranges::find_if(vehicle.lines, [](const ConditionLine& line) { return line.name == "heartbeat"; });
  if (vehicle.has_applied || heartbeat == vehicle.lines.end() || heartbeat->ok) return {};
  return "zero was sent, but nobody knows what the vehicle does: " + printable(heartbeat->text);
}

/// What THRUSTERS' zero is worth.
const char* meaning(const std::optional<VehicleCondition>& vehicle) {
  const bool as_sent = vehicle && !vehicle->has_applied && vehicle->heartbeat_age >= 0.0;
  return as_sent ? " (as it was sent: the vehicle does not report what it applies)" : "";
}

}  // namespace

void abort_now(Console& console, bool checked) {
  console.asked = unforeseeable();
  console.answers.clear();
  int in_a_row = 0;
  std::optional<Thrusters> last;
  const auto answered = [&]() -> const Answer* {
    for (const auto& [process, each] : console.answers) {
      if (each.gate && each.done) return &each;
    }
    return nullptr;
  };
  console.on_thrusters = [&](const Thrusters& heard) {
    if (answered() == nullptr) return;
    last = heard;
    in_a_row = is_zero(heard) ? in_a_row + 1 : 0;
  };
  const auto done = [&] { return in_a_row >= kInARow; };
  const auto begin = Console::Clock::now();
  const auto passed = [&] { return std::chrono::duration<double>(Console::Clock::now() - begin).count(); };
  while (passed() < kWithin && !done()) {
    console.say({.utime = console.vehicle_time().value_or(wall_clock()), .sequence = console.asked, .abort = true});
    console.listen(kAgain, done);
  }
  console.on_thrusters = {};
  for (const auto& [process, each] : console.answers)
    std::printf("%-16s %s\n", printable(process).c_str(), printable(each.text).c_str());
  const double after = passed();
  const bool simulated = std::ranges::all_of(
      console.answers, [](const auto& each) { return !each.second.gate || each.second.process == "simulator"; });
  if (done() && !simulated) {
    console.vehicle.reset();  // of before
    console.listen(kVehicle, [&] { return console.vehicle.has_value(); });
  }
  const auto doubt = [&]() -> std::string {
    if (answered() == nullptr) return "no thruster driver answered within 2 s";
    if (!last) return "the driver asks for zero, but nothing says on THRUSTERS what the vehicle does";
    if (done() && !simulated && !console.vehicle)
      return "zero was sent, but nothing is heard on VEHICLE of what is behind the driver";
    if (done()) return console.vehicle ? silence_of(*console.vehicle) : "";
    if (is_zero(*last)) return "THRUSTERS says zero, but not three times in 2 s";
    char text[100];
    std::snprintf(text, sizeof text, "THRUSTERS still says %.3g (N or N m) after 2 s", strongest(*last));
    return text;
  };
  const std::string why = doubt();
  if (why.empty()) {
    std::printf("aborted, confirmed after %.1f s: THRUSTERS says zero%s%s\n", after, meaning(console.vehicle),
                checked ? "" : " (with --operator the answer's signature is checked, too)");
    return;
  }
  std::fflush(stdout);
  throw InputError("abort NOT CONFIRMED: " + why + ". " + kByHand);
}

}  // namespace fathom::tool
