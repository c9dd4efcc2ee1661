// The simulated instruments at real lines: what they say leaves as bytes in their own units, axes and clocks, what
// drivers ask is answered, and what the thrusters are told comes back. The drivers' file says which lines there are.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "common/model/vehicle.hpp"
#include "common/simulation/sensor.hpp"

namespace fathom::simulator {

class Instruments {
 public:
  /// Plays those instruments of `drivers` (a file as drivers read it) that are `carried`, and the thrusters; opens the
  /// other ends of their links. InputError names what cannot be played.
  Instruments(const std::string& drivers, const model::Vehicle& vehicle, const std::vector<std::string>& carried);
  ~Instruments();
  Instruments(const Instruments&) = delete;
  Instruments& operator=(const Instruments&) = delete;

  /// The run begins.
  void begin_at(Utime origin) { origin_ = origin; }
  /// Drivers that have not opened their line yet, with their links; empty when all have.
  [[nodiscard]] std::string absent() const;
  /// Answers whoever asks; `now` [s] of any steady clock. Never waits.
  void serve(double now);
  /// Says it at its line, now; false when it has none, and its channel must be spoken on.
  bool say(const simulation::Sample& sample);
  /// True when a driver of thrusters has a line: it obeys commands, not we.
  [[nodiscard]] bool driven() const { return rig_ != nullptr; }
  /// What it told the thrusters, as Simulator::drive() takes it.
  [[nodiscard]] std::vector<double> told() const;

 private:
  struct Line;
  struct Speaker;
  class Autopilot;
  [[nodiscard]] Line* line(const char* section) const;

  const model::Vehicle* vehicle_;
  std::vector<std::unique_ptr<Line>> lines_;
  Line* rig_{};
  std::unique_ptr<Autopilot> autopilot_;  ///< where the driver moves the pilot's sticks
  Utime origin_{};
  Ahrs attitude_;     ///< newest that was said: other instruments have compass and tilts of their own
  double voltage_{};  ///< V, told with the next report of the thrusters; 0: nothing new
};

}  // namespace fathom::simulator
