// Whether an abort is done: when the vehicle says so, not when it was said.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>

#include "common/samples/commands.hpp"
#include "common/samples/sensors.hpp"
#include "common/samples/vehicle_condition.hpp"

namespace fathom::orders {

/// Pure: times are passed in, in seconds of any steady clock. Confirmed when who moves the thrusters has answered and
/// THRUSTERS says zero three times after that, within 2 s, and the vehicle behind the driver then reports its outputs
/// or gives a sign of life.
class AbortWatch {
 public:
  static constexpr double kWithin = 2.0;   ///< s in which it must be confirmed
  static constexpr double kVehicle = 1.7;  ///< s more for VEHICLE, which comes twice a second: two may be lost
  static constexpr double kAgain = 0.1;    ///< s between two aborts: any may be lost
  static constexpr double kZero = 0.1;     ///< N, N m: what a pulse width rounded to a microsecond may stand for
  static constexpr int kInARow = 3;        ///< of THRUSTERS, after the answer, so that none of before is counted
  static constexpr char kByHand[] =
      "By hand, now: 1. the vehicle's kill switch, or its power; 2. disarm it in the ground station; 3. pull it in by "
      "the tether. Then abort again, until it is confirmed.";

  /// `number` of the order, which no one can foresee.
  AbortWatch(std::int64_t number, double now) : number_{number}, begin_{now} {}

  [[nodiscard]] std::int64_t number() const { return number_; }
  void hear(const Answer& said);
  void hear(const Thrusters& said);
  void hear(const VehicleCondition& said);
  /// Whether the order shall be said (again); then it has been.
  [[nodiscard]] bool speaks(double now);

  struct Outcome {
    bool confirmed{};
    std::string text;  ///< what is known, or why not
  };
  /// Nothing while it is not known yet.
  [[nodiscard]] std::optional<Outcome> outcome(double now) const;
  [[nodiscard]] const std::map<std::string, Answer>& answers() const { return answers_; }

 private:
  [[nodiscard]] bool answered() const;
  [[nodiscard]] bool simulated() const;
  [[nodiscard]] std::string doubt() const;

  std::int64_t number_;
  double begin_;
  std::optional<double> said_, done_;        ///< s: the order last; zero for the third time
  std::map<std::string, Answer> answers_;    ///< to this order, by process
  bool heard_{false};                        ///< THRUSTERS, after the answer
  std::optional<Thrusters> pushed_;          ///< the newest of these that was not zero
  std::optional<VehicleCondition> vehicle_;  ///< after zero was said
  int in_a_row_{};
};

}  // namespace fathom::orders
