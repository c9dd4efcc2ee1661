// Hands that steer: what is asked for, and that nothing is when the hand lets go.
#include "common/orders/hand.hpp"

#include <doctest/doctest.h>
#include <linux/joystick.h>

#include <cstring>
#include <string>

using namespace fathom;
using orders::Joystick;
using orders::Keyboard;

namespace {

std::string event(std::int16_t value, int type, std::uint8_t number) {
  js_event e{.time = 0, .value = value, .type = static_cast<std::uint8_t>(type), .number = number};
  std::string bytes(sizeof e, '\0');
  std::memcpy(bytes.data(), &e, sizeof e);
  return bytes;
}

constexpr std::uint8_t kDeadMan = 4;

}  // namespace

TEST_CASE("hand: a key counts while it is held, the opposite one replaces it, and others steer nothing") {
  Keyboard keys;
  CHECK_FALSE(keys.shares(0.0));
  CHECK_FALSE(keys.press('z', 0.0));
  CHECK_FALSE(keys.shares(0.0));
  CHECK(keys.press('w', 1.0));
  CHECK(keys.press('e', 1.1));
  const auto both = keys.shares(1.2);
  REQUIRE(both);
  CHECK((*both)[0] == 1.0);
  CHECK((*both)[5] == 1.0);
  CHECK(keys.press('s', 1.3));
  CHECK((*keys.shares(1.3))[0] == -1.0);
  CHECK(keys.press('r', 1.3));
  CHECK((*keys.shares(1.3))[2] == -1.0);  // up
  CHECK_FALSE(keys.shares(1.3 + Keyboard::kHeld + 0.01));
}

TEST_CASE(
    "hand: a joystick's sticks count only while the dead man's button is held, and not if it was from the start") {
  Joystick stick{kDeadMan};
  stick.feed(event(-32767, JS_EVENT_AXIS, 1));
  CHECK_FALSE(stick.shares());
  stick.feed(event(1, JS_EVENT_BUTTON | JS_EVENT_INIT, kDeadMan));  // jammed
  CHECK_FALSE(stick.shares());
  stick.feed(event(1, JS_EVENT_BUTTON, kDeadMan));
  CHECK_FALSE(stick.shares());
  stick.feed(event(0, JS_EVENT_BUTTON, kDeadMan) + event(1, JS_EVENT_BUTTON, kDeadMan));
  REQUIRE(stick.shares());
  CHECK((*stick.shares())[0] == doctest::Approx(1.0));
  CHECK((*stick.shares())[1] == 0.0);
  const std::string half = event(32767, JS_EVENT_AXIS, 3);
  stick.feed(half.substr(0, 3));  // in parts
  CHECK((*stick.shares())[5] == 0.0);
  stick.feed(half.substr(3) + event(2000, JS_EVENT_AXIS, 0) + event(-32767, JS_EVENT_AXIS, 4));
  CHECK((*stick.shares())[5] == doctest::Approx(1.0));
  CHECK((*stick.shares())[1] == 0.0);  // not quite back in the middle
  CHECK((*stick.shares())[2] == doctest::Approx(-1.0));
  stick.feed(event(0, JS_EVENT_BUTTON, kDeadMan));
  CHECK_FALSE(stick.shares());
}
