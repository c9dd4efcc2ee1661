#include "common/orders/hand.hpp"

#include <linux/joystick.h>

#include <cmath>
#include <cstring>

namespace fathom::orders {

bool Keyboard::press(char key, double now) {
  for (std::size_t i = 0; i < kAll.size(); ++i) {
    if (kAll[i].key != key) continue;
    for (std::size_t j = 0; j < kAll.size(); ++j) {  // who presses back no longer wants ahead
      if (kAll[j].axis == kAll[i].axis) pressed_at_[j] = -1e9;
    }
    pressed_at_[i] = now;
    return true;
  }
  return false;
}

// A terminal repeats only the key that went down last: the others go on while that one is held, and no longer.
std::optional<Vector6d> Keyboard::shares(double now) const {
  Vector6d shares = Vector6d::Zero();
  bool any = false;
  for (std::size_t i = 0; i < kAll.size(); ++i) {
    if (now - pressed_at_[i] > kHeld) continue;
    any = true;
    shares[kAll[i].axis] = kAll[i].sign;
  }
  if (!any) return {};
  return shares;
}

void Joystick::feed(const std::string& bytes) {
  rest_ += bytes;
  std::size_t at = 0;
  for (; rest_.size() - at >= sizeof(js_event); at += sizeof(js_event)) {
    js_event e{};
    std::memcpy(&e, rest_.data() + at, sizeof e);
    event(e.value, e.type, e.number);
  }
  rest_.erase(0, at);
}

void Joystick::event(std::int16_t value, std::uint8_t type, std::uint8_t number) {
  const bool at_the_start = (type & JS_EVENT_INIT) != 0;
  const int kind = type & ~JS_EVENT_INIT;
  if (kind == JS_EVENT_BUTTON && number == dead_man_) {
    if (value == 0) seen_up_ = true;
    held_ = value != 0 && seen_up_ && !at_the_start;
  } else if (kind == JS_EVENT_AXIS && number < axis_.size()) {
    constexpr double kThrow = 32767.0;
    const double share = std::fmax(-1.0, static_cast<double>(value) / kThrow);
    axis_[number] = std::abs(share) < kRest ? 0.0 : std::copysign((std::abs(share) - kRest) / (1.0 - kRest), share);
  }
}

std::optional<Vector6d> Joystick::shares() const {
  constexpr std::size_t kLeftAcross = 0, kLeftAlong = 1, kRightAcross = 3, kRightAlong = 4;
  if (!held_) return {};
  Vector6d shares = Vector6d::Zero();
  shares[0] = -axis_[kLeftAlong];  // away from the hand is negative
  shares[1] = axis_[kLeftAcross];
  shares[2] = axis_[kRightAlong];  // away: up
  shares[5] = axis_[kRightAcross];
  return shares;
}

}  // namespace fathom::orders
