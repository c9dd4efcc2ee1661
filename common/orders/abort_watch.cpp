#include "common/orders/abort_watch.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "common/base/printable.hpp"

namespace fathom::orders {
namespace {

bool is_zero(const Thrusters& thrusters) {
  const auto small = [](double value) { return std::abs(value) < AbortWatch::kZero; };
  return std::ranges::all_of(thrusters.force, small) && std::ranges::all_of(thrusters.tau, small);
}

double strongest(const Thrusters& thrusters) {
  double most = 0.0;
  for (const double each : thrusters.force) most = std::max(most, std::abs(each));
  for (const double each : thrusters.tau) most = std::max(most, std::abs(each));
  return most;
}

/// A line that leads nowhere is asked for zero like any other, and THRUSTERS says what was sent: then nobody knows what
/// the vehicle does. Empty: it reports what it applies, or is alive, or there is none (a simulator, a dry run).
std::string silence_of(const VehicleCondition& vehicle) {
  const auto heartbeat =
      std::ranges::find_if(vehicle.lines, [](const ConditionLine& line) { return line.name == "heartbeat"; });
  if (vehicle.has_applied || heartbeat == vehicle.lines.end() || heartbeat->ok) return {};
  return "zero was sent, but nobody knows what the vehicle does: " + printable(heartbeat->text);
}

}  // namespace

void AbortWatch::hear(const Answer& said) {
  if (said.sequence == number_) answers_.emplace(said.process, said);
}

void AbortWatch::hear(const Thrusters& said) {
  if (done_ || !answered()) return;
  heard_ = true;
  if (!is_zero(said)) pushed_ = said;
  in_a_row_ = is_zero(said) ? in_a_row_ + 1 : 0;
}

void AbortWatch::hear(const VehicleCondition& said) {
  if (in_a_row_ >= kInARow) vehicle_ = said;
}

bool AbortWatch::speaks(double now) {
  if (!done_ && in_a_row_ >= kInARow) done_ = now;
  if (done_ || now - begin_ >= kWithin || (said_ && now - *said_ < kAgain)) return false;
  said_ = now;
  return true;
}

bool AbortWatch::answered() const {
  return std::ranges::any_of(answers_, [](const auto& each) { return each.second.gate && each.second.done; });
}

bool AbortWatch::simulated() const {
  return std::ranges::all_of(answers_,
                             [](const auto& each) { return !each.second.gate || each.second.process == "simulator"; });
}

std::string AbortWatch::doubt() const {
  const bool done = in_a_row_ >= kInARow;
  if (!answered()) return "no thruster driver answered within 2 s";
  if (!heard_) return "the driver asks for zero, but nothing says on THRUSTERS what the vehicle does";
  if (done && !simulated() && !vehicle_)
    return "zero was sent, but nothing is heard on VEHICLE of what is behind the driver";
  if (done) return vehicle_ ? silence_of(*vehicle_) : "";
  if (!pushed_) return "THRUSTERS says zero, but not three times in 2 s";
  char text[100];
  std::snprintf(text, sizeof text, "THRUSTERS still says %.3g (N or N m) after 2 s", strongest(*pushed_));
  return text;
}

std::optional<AbortWatch::Outcome> AbortWatch::outcome(double now) const {
  if (in_a_row_ < kInARow) {
    if (now - begin_ < kWithin) return {};
  } else if (!vehicle_ && !simulated() && now - done_.value_or(now) < kVehicle) {
    return {};
  }
  if (const std::string why = doubt(); !why.empty())
    return Outcome{false, "abort NOT CONFIRMED: " + why + ". " + kByHand};
  const bool as_sent = vehicle_ && !vehicle_->has_applied && vehicle_->heartbeat_age >= 0.0;
  char text[160];
  std::snprintf(text, sizeof text, "aborted, confirmed after %.1f s: THRUSTERS says zero%s",
                done_.value_or(now) - begin_,
                as_sent ? " (as it was sent: the vehicle does not report what it applies)" : "");
  return Outcome{true, text};
}

}  // namespace fathom::orders
