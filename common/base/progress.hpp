// What long work says of itself while it goes on. The work names its phases and counts their units; how long the rest
// will take is worked out from that by whoever listens (RemainingTime), so that no work states shares of its time.
#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <utility>

namespace fathom {

/// A handle, cheap to copy; a default one tells nobody. Calls may come from several threads if the listener allows it.
class Progress {
 public:
  struct Event {
    enum class Kind { kExpect, kBegin, kDone };
    Kind kind{};
    std::string_view phase;  ///< identifies it, and is not shown
    std::string_view what;   ///< kBegin: what is being done, for people
    double units{};          ///< kExpect: to come from now on; kDone: finished
    double weight{1.0};      ///< kExpect: guessed cost of a unit against those of the other phases
  };

  Progress() = default;
  explicit Progress(std::function<void(const Event&)> listener) : listener_{std::move(listener)} {}

  /// So many units of a phase are still to come, the one that is going on included. Whenever that changes it is said
  /// anew: it replaces what was said before. `weight` counts until the first units have been timed.
  void expect(std::string_view phase, double units, double weight = 1.0) const {
    tell({.kind = Event::Kind::kExpect, .phase = phase, .units = units, .weight = weight});
  }
  /// From now on time is spent in this phase.
  void begin(std::string_view phase, std::string_view what) const {
    tell({.kind = Event::Kind::kBegin, .phase = phase, .what = what});
  }
  void done(std::string_view phase, double units = 1.0) const {
    tell({.kind = Event::Kind::kDone, .phase = phase, .units = units});
  }
  /// The same to listeners, of work whose phases are others by their name and whose units cost so many times as much.
  [[nodiscard]] Progress part(std::string name, double cost) const {
    return Progress{[whole = *this, name = std::move(name), cost](const Event& event) {
      const std::string phase = name + std::string{event.phase};
      Event told = event;
      told.phase = phase;
      told.weight *= cost;
      whole.tell(told);
    }};
  }

 private:
  void tell(const Event& event) const {
    if (listener_) listener_(event);
  }
  std::function<void(const Event&)> listener_;
};

}  // namespace fathom
