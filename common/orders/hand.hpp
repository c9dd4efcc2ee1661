// A hand that steers: what keys or a joystick ask for, and whether somebody is there. Nothing is asked for longer than
// a hand holds on: the dead man.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>

#include "common/base/spatial.hpp"

namespace fathom::orders {

/// A terminal tells when a key goes down and repeats it while it is held, but not when it goes up. A key counts for
/// kHeld after its last word, since the first repetition may take half a second.
class Keyboard {
 public:
  static constexpr double kHeld = 0.6;  ///< s
  static constexpr const char* kKeys =
      "w s ahead, back   a d to port, to starboard   r f up, down   q e turn to port, to starboard";

  /// True for a key that steers. `now` [s] of any steady clock.
  bool press(char key, double now);
  /// Shares of the largest force and moment, -1 to 1, X Y Z K M N; nothing while no key is held.
  [[nodiscard]] std::optional<Vector6d> shares(double now) const;

 private:
  struct Key {
    char key;
    Eigen::Index axis;
    double sign;
  };
  static constexpr std::array<Key, 8> kAll{{{'w', 0, 1.0},
                                            {'s', 0, -1.0},
                                            {'a', 1, -1.0},
                                            {'d', 1, 1.0},
                                            {'r', 2, -1.0},
                                            {'f', 2, 1.0},
                                            {'q', 5, -1.0},
                                            {'e', 5, 1.0}}};
  std::array<double, kAll.size()> pressed_at_{-1e9, -1e9, -1e9, -1e9, -1e9, -1e9, -1e9, -1e9};
};

/// Events of the kernel's joystick interface (/dev/input/jsN; linux/joystick.h): eight bytes each, in the host's order.
/// Left stick ahead and sideways, right stick turns and dives, as an Xbox pad numbers them. Nothing is asked for unless
/// the dead man's button is held, and it must have been seen to be up before.
class Joystick {
 public:
  static constexpr double kRest = 0.1;  ///< of full throw: sticks do not come back to the very middle

  explicit Joystick(int dead_man) : dead_man_{dead_man} {}
  void feed(const std::string& bytes);
  [[nodiscard]] std::optional<Vector6d> shares() const;

 private:
  void event(std::int16_t value, std::uint8_t type, std::uint8_t number);

  int dead_man_;
  bool seen_up_{false}, held_{false};
  std::array<double, 8> axis_{};
  std::string rest_;  // of an event that came in parts
};

}  // namespace fathom::orders
