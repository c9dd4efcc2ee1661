// A trial flown in advance: the vehicle file's own model in the place of the vehicle, the real supervisor and the real
// identifier. No simulator: what is planned rests on what the owner states, and on nothing else.
#pragma once

#include <string>
#include <vector>

#include "common/excitation/supervisor.hpp"
#include "common/identification/identifier.hpp"
#include "common/samples/trial.hpp"

namespace fathom::planning {

struct RehearsalSettings {
  excitation::SupervisorSettings supervisor;
  identification::IdentifierSettings identifier;
  double longest{600.0};                      ///< s after which the trial is ended
  Vector6d noise{Vector6d::Constant(0.005)};  ///< m/s, rad/s of a sample of STATE, `rate` of them per second
  double rate{100.0};                         ///< Hz
};

struct Rehearsal {
  Trial trial;  ///< without noise; nu_sigma is that of its samples, which are fewer than those of the vehicle
  std::vector<excitation::Supervisor::Visit> visits;
  std::string end;  ///< why it ended, in the supervisor's words
};

/// InputError when the supervisor does not arm or aborts at once.
[[nodiscard]] Rehearsal rehearse(const model::Vehicle& vehicle, const RehearsalSettings& settings);

/// One segment from rest in the middle of the room, again and again for `duration` [s] with a sample at its end, bent
/// by the fence; the axes that it leaves alone are held. The model's inputs are the wrench or the thrusters' forces.
[[nodiscard]] Trial fly(const model::Vehicle& vehicle, const model::Model& model, bool by_wrench,
                        const RehearsalSettings& settings, const excitation::Segment& segment, double duration);

}  // namespace fathom::planning
