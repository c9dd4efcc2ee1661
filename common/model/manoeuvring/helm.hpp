// Who puts a manoeuvre into force: two thrusters, or rudders and the propellers that keep a cruising speed.
#pragma once

#include "common/model/manoeuvres.hpp"
#include "common/model/motion.hpp"

namespace fathom::model {

class Helm {
 public:
  /// Both outlive it. InputError where the vehicle has neither two thrusters nor a rudder, or with a rudder no cruising
  /// speed that its propellers can keep.
  Helm(const Vehicle& vehicle, const Manoeuvre& manoeuvre);
  [[nodiscard]] bool steered() const { return steered_; }
  /// Forces [N] of all actuators by what the pilot wants, `dt` [s] after the last.
  [[nodiscard]] const ActuatorForces& forces(const ManoeuvrePilot::Demand& demand, double dt);

 private:
  void keep_cruise();
  [[nodiscard]] double gain(double thrust);

  const Vehicle& vehicle_;
  const Manoeuvre& manoeuvre_;
  bool steered_;
  ActuatorForces force_;
  double angle_{};  ///< rad, of the rudders
};

}  // namespace fathom::model
