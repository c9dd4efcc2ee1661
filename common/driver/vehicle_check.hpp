// What stands behind the thruster driver: is it the vehicle that is to be driven, is it well, and does it obey?
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "common/driver/following.hpp"
#include "common/model/thruster_allocation.hpp"
#include "common/samples/vehicle_condition.hpp"

namespace fathom::devices {
class Mavlink;
class ThrusterText;
}  // namespace fathom::devices

namespace fathom::driver {

/// Pure: times are passed in, in seconds of any steady clock.
class VehicleCheck {
 public:
  enum class Kind { kArdusub, kRig, kDryRun };
  struct Expected {
    Kind kind{Kind::kArdusub};
    int system{1};                   ///< MAVLink number that commands are meant for
    std::vector<std::string> modes;  ///< in which it obeys; empty: any
    double voltage_floor{};          ///< V; 0: none is known
    bool must_report{false};         ///< what is applied is known from its reports alone (RC override)
    double largest_thrust{};         ///< N, of one thruster
  };
  /// Each with its reason.
  struct Limits {
    double heartbeat{3.0};      ///< s: three of a vehicle's heartbeats
    double refusal{3.0};        ///< s that a refused motor test counts, if it is not refused again
    double words{30.0};         ///< s that the vehicle's words count: ArduSub says "Leak Detected" again every 20 s
    double low_voltage{2.0};    ///< s below the floor: what a start of all thrusters takes is no empty battery
    double stale_voltage{5.0};  ///< s
    int told_severity{4};       ///< words up to warnings are told
    int grave_severity{3};      ///< errors and worse end a trial
    double least_asked{0.1};    ///< [1] of one thruster's largest: below that it is not judged whether it follows
  };

  explicit VehicleCheck(const Expected& expected) : VehicleCheck(expected, Limits{}) {}
  VehicleCheck(const Expected& expected, const Limits& limits);
  /// The line was opened anew: what was heard before is of another time.
  void restart(double now);
  /// The latest packet or sentence of the parser.
  void hear(const devices::Mavlink& packet, double now);
  void hear(const devices::ThrusterText& sentence, double now);
  void hear_voltage(double voltage, double now);
  /// What is sent, once per command; what the vehicle reports.
  void asked(const model::Allocated& allocated, double now);
  void applied(const model::Allocated& allocated, double now);

  [[nodiscard]] VehicleCondition condition(Utime utime, double now) const;

 private:
  [[nodiscard]] bool within(const std::optional<double>& when, double now, double limit) const {
    return when && now - *when <= limit;
  }
  [[nodiscard]] std::string heartbeat_trouble(double now) const;
  [[nodiscard]] std::string another_vehicle(double now) const;
  void say(VehicleCondition& condition, double now) const;
  void remember(VehicleText words, double now);

  struct Words {
    VehicleText said;
    double at{};
  };
  Expected expected_;
  Limits limits_;
  Following following_;
  double begun_{};
  std::optional<double> right_at_, wrong_at_, refused_at_, beat_at_;
  std::string wrong_;
  int result_{};
  int armed_{-1};
  std::string mode_;
  bool failsafe_{false};
  bool tells_state_{false};  ///< of a rig: it has said $FTSTA
  std::vector<Words> words_;
  double voltage_{};
  std::optional<double> voltage_at_, low_since_;
  Vector6d asked_{Vector6d::Zero()}, applied_{Vector6d::Zero()};
};

/// The first condition that does not hold, as HEALTH says it; empty: all hold.
[[nodiscard]] std::string first_trouble(const VehicleCondition& condition);

}  // namespace fathom::driver
