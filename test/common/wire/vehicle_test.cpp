// VEHICLE: nothing is lost or swapped on the way, and no number that is none comes in.
#include "common/wire/vehicle.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <fathom_lcm/vehicle_condition_t.hpp>

namespace fathom {
namespace {

VehicleCondition filled() {
  VehicleCondition sample{.utime = 1'600'000'000'000'000,
                          .kind = "ArduSub",
                          .heartbeat_age = 0.25,
                          .armed = 0,
                          .mode = "STABILIZE",
                          .failsafe = true,
                          .voltage = 14.5,
                          .voltage_floor = 12.0};
  sample.asked << 1, 2, 3, 4, 5, 6;
  sample.has_applied = true;
  sample.applied << 7, 8, 9, 10, 11, 12;
  sample.texts = {{2, "Leak Detected", 1.5}, {4, "EKF variance", 3.5}};
  sample.lines = {{"armed", false, false, "the vehicle is disarmed"}, {"leak", true, true, "none"}};
  return sample;
}

std::vector<std::uint8_t> bytes_of(const fathom_lcm::vehicle_condition_t& message) {
  std::vector<std::uint8_t> bytes(static_cast<std::size_t>(message.getEncodedSize()));
  message.encode(bytes.data(), 0, static_cast<int>(bytes.size()));
  return bytes;
}

fathom_lcm::vehicle_condition_t sent(const VehicleCondition& sample) {
  const std::vector<std::uint8_t> bytes = bytes_of(wire::encode(sample));
  fathom_lcm::vehicle_condition_t back{};
  const int length = static_cast<int>(bytes.size());
  const bool whole = length > 8 && back.decode(bytes.data(), 0, length) == length;
  REQUIRE(whole);
  return back;
}

}  // namespace

TEST_CASE("wire: a vehicle's condition comes back whole") {
  const VehicleCondition told = filled();
  const auto back = wire::decode(sent(told));
  REQUIRE(back.has_value());
  CHECK(back->utime == told.utime);
  CHECK(back->kind == "ArduSub");
  CHECK(back->heartbeat_age == 0.25);
  CHECK(back->armed == 0);
  CHECK(back->mode == "STABILIZE");
  CHECK(back->failsafe);
  CHECK(back->voltage == 14.5);
  CHECK(back->voltage_floor == 12.0);
  CHECK(back->asked == told.asked);
  CHECK(back->has_applied);
  CHECK(back->applied == told.applied);
  REQUIRE(back->texts.size() == 2);
  CHECK(back->texts[0].severity == 2);
  CHECK(back->texts[0].text == "Leak Detected");
  CHECK(back->texts[1].age == 3.5);
  REQUIRE(back->lines.size() == 2);
  CHECK(back->lines[0].name == "armed");
  CHECK_FALSE(back->lines[0].ok);
  CHECK_FALSE(back->lines[0].grave);
  CHECK(back->lines[1].ok);
  CHECK(back->lines[1].grave);
  CHECK(back->lines[1].text == "none");
}

TEST_CASE("wire: a vehicle's condition with a number that is none, or a length that is not the real one, is refused") {
  const auto refused = [](auto damage) {
    auto message = wire::encode(filled());
    damage(message);
    return !wire::decode(message).has_value();
  };
  const double bad = std::nan("");
  CHECK_FALSE(refused([](auto&) {}));
  CHECK(refused([&](auto& m) { m.heartbeat_age = bad; }));
  CHECK(refused([&](auto& m) { m.voltage = HUGE_VAL; }));
  CHECK(refused([&](auto& m) { m.voltage_floor = bad; }));
  CHECK(refused([&](auto& m) { m.asked[5] = bad; }));
  CHECK(refused([&](auto& m) { m.applied[0] = -HUGE_VAL; }));
  CHECK(refused([&](auto& m) { m.texts[1].age = bad; }));
  CHECK(refused([](auto& m) { m.n_texts = 1; }));
  CHECK(refused([](auto& m) { m.lines.emplace_back(); }));
}

}  // namespace fathom
