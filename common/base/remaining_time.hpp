// How long work that is going on will still take, from what its phases have cost so far.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/base/progress.hpp"

namespace fathom {

/// Remaining time is the sum over phases of (units to come) x (seconds per unit). Seconds per unit are measured: a mean
/// over the latest units of that phase, with one unit's weight on its guess, which is the stated weight times the
/// seconds per weight of all that has been done. The unit that is going on counts with what is expected of it beyond
/// its age; once it is older than expected, with a share of that age, so that what hangs is never "nearly done".
/// No clock of its own: seconds are the caller's, from any origin, not decreasing.
class RemainingTime {
 public:
  void take(double now, const Progress::Event& event);
  /// s; empty until a fiftieth of the work, by its weights, is done.
  [[nodiscard]] std::optional<double> left(double now) const;

 private:
  struct Phase {
    std::string name;
    double weight{1.0};
    double to_come{};        // units
    double units{}, time{};  // all that is done, s
    double recent_units{}, recent_time{};
    double running{};  // s spent since the last unit was done
  };
  Phase& phase(std::string_view name);
  void spend(double now);

  std::vector<Phase> phases_;
  std::size_t current_{};
  bool begun_{false};
  double since_{};  // time before that is in the phases
};

/// "about 40 s left", as finely as such a guess deserves.
[[nodiscard]] std::string time_left(double seconds);

}  // namespace fathom
