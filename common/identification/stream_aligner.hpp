// States meet inputs and voltages by their time stamps, never by the order of arrival, so that a replay over the
// network and a log read directly give the same numbers to the last bit.
#pragma once

#include <optional>
#include <vector>

#include "common/model/motion.hpp"
#include "common/samples/estimates.hpp"

namespace fathom::identification {

struct AlignmentSettings {
  bool interpolate{true};     ///< false: an input holds until the next
  double max_input_gap{0.5};  ///< s; a state between inputs further apart has no input
  double max_skew{0.5};       ///< s by which one channel may lag the other without changing the result
  bool voltage{false};        ///< true: a state also waits for the voltage at its time, max_skew at most
};

class StreamAligner {
 public:
  /// A state ready for use. Without an input near it, `input` is empty. Trapezoids over the inputs of a row of states
  /// give the integral of a held input, wherever between the states it jumps.
  struct Aligned {
    StateEstimate state;
    std::optional<model::ActuatorForces> input;
    double voltage{};  ///< V, of the newest sample at or before the state; 0: none
  };

  explicit StreamAligner(const AlignmentSettings& settings) : settings_{settings} {}

  /// False: not newer than the one before, and not taken.
  bool push(const StateEstimate& state);
  bool push_input(Utime utime, const model::ActuatorForces& input);
  bool push_voltage(Utime utime, double voltage);

  /// Next state in time order whose fate no later arrival can change; with `all`, whose fate the end of the streams
  /// decides. Call until it is empty.
  [[nodiscard]] std::optional<Aligned> next(bool all = false);
  /// Input at `utime` from those around it; nothing when they are too far apart. Reaches some seconds back.
  [[nodiscard]] std::optional<model::ActuatorForces> input_at(Utime utime) const;
  void reset();

 private:
  struct Input {
    Utime utime{};
    model::ActuatorForces value;
  };
  struct Voltage {
    Utime utime{};
    double value{};
  };
  [[nodiscard]] bool settled(Utime utime, bool covered) const;
  void make_up(Utime from, Utime to, model::ActuatorForces& input) const;
  void forget();

  AlignmentSettings settings_;
  std::vector<StateEstimate> pending_;
  std::size_t done_{};  // of pending_
  std::vector<Input> inputs_;
  std::vector<Voltage> voltages_;
  std::optional<Utime> last_state_, before_;  ///< newest that came; newest that was given out
};

}  // namespace fathom::identification
