// What the supervisor flies when a trial has ended without its operator's order: nothing, hold the depth, or go to the
// surface, as the vehicle file says. A vehicle that is heavy sinks with zero thrust.
#pragma once

#include <optional>
#include <string>

#include "common/excitation/hold.hpp"
#include "common/model/after_abort.hpp"

namespace fathom::excitation {

/// Moves along the vertical alone: nobody knows whether the rest of the state can still be believed.
class DepthAction {
 public:
  /// `surface` [m]: z of Bo when the vehicle's top is at the water's surface.
  DepthAction(const model::AfterAbort& after, double surface) : after_{after}, surface_{surface} {}

  /// From this state on. Does nothing for zero thrust.
  void begin(const StateEstimate& state);
  void end() { begun_.reset(); }
  [[nodiscard]] bool active() const { return begun_.has_value(); }
  /// The wrench that is wanted now [N, N m]; zero while it cannot be flown. `hold` knows the trim. Ends by itself.
  /// `dt` [s] since the last.
  [[nodiscard]] Vector6d step(const StateEstimate& state, Hold& hold, double dt);
  /// "goes to the surface, at most 60 s"; after its end why. Empty: it has not begun.
  [[nodiscard]] const std::string& text() const { return text_; }

 private:
  model::AfterAbort after_;
  double surface_;
  std::optional<Utime> begun_;
  double aim_{};  // m, z that is aimed at now
  bool aimed_{false};
  std::string text_;
};

}  // namespace fathom::excitation
