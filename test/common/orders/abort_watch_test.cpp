// An abort is done when the vehicle says so: each sign that may lack, one after the other.
#include "common/orders/abort_watch.hpp"

#include <doctest/doctest.h>

namespace fathom::orders {
namespace {

constexpr std::int64_t kNumber = 77;

Answer answer(const std::string& process, std::int64_t sequence = kNumber) {
  return {.process = process, .gate = true, .sequence = sequence, .done = true, .text = "aborted"};
}

Thrusters thrust(double force) {
  Thrusters said{.force = {0.0, force}, .has_tau = true};
  said.tau[0] = force;
  return said;
}

VehicleCondition alive(bool heartbeat) {
  return {.kind = "ArduSub",
          .heartbeat_age = heartbeat ? 0.5 : 20.0,
          .lines = {{.name = "heartbeat", .ok = heartbeat, .text = heartbeat ? "heard" : "no heartbeat for 20 s"}}};
}

void three_zeros(AbortWatch& watch, double now) {
  for (int i = 0; i < AbortWatch::kInARow; ++i) watch.hear(thrust(0.0));
  CHECK_FALSE(watch.speaks(now));
}

}  // namespace

TEST_CASE("abort: it is said again until it is done, and done with the answer, three zeros and a vehicle that lives") {
  AbortWatch watch{kNumber, 10.0};
  CHECK(watch.speaks(10.0));
  CHECK_FALSE(watch.speaks(10.05));
  CHECK(watch.speaks(10.11));
  watch.hear(thrust(0.0));  // before the answer: of before
  watch.hear(answer("thruster_driver", kNumber + 1));
  watch.hear(thrust(0.0));
  CHECK(watch.answers().empty());
  watch.hear(answer("thruster_driver"));
  watch.hear(thrust(0.0));
  watch.hear(thrust(0.0));
  watch.hear(thrust(5.0));  // not in a row
  watch.hear(thrust(0.0));
  CHECK_FALSE(watch.outcome(10.2));
  three_zeros(watch, 10.3);
  CHECK_FALSE(watch.outcome(10.4));  // the vehicle itself has not spoken since
  watch.hear(alive(true));
  const auto outcome = watch.outcome(10.8);
  REQUIRE(outcome);
  CHECK(outcome->confirmed);
  CHECK(outcome->text ==
        "aborted, confirmed after 0.3 s: THRUSTERS says zero (as it was sent: the vehicle does not report what it "
        "applies)");
}

TEST_CASE("abort: a simulator is the vehicle itself: nobody else need speak") {
  AbortWatch watch{kNumber, 0.0};
  watch.hear(answer("simulator"));
  three_zeros(watch, 0.1);
  REQUIRE(watch.outcome(0.1));
  CHECK(watch.outcome(0.1)->confirmed);
}

TEST_CASE("abort: whatever lacks is told, with what is left to the hands, and not before its time") {
  const auto told = [](const AbortWatch& watch, double now) {
    const auto outcome = watch.outcome(now);
    REQUIRE(outcome);
    CHECK_FALSE(outcome->confirmed);
    CHECK(outcome->text.find("kill switch") != std::string::npos);
    return outcome->text;
  };
  AbortWatch nobody{kNumber, 0.0};
  CHECK_FALSE(nobody.outcome(1.9));
  CHECK(told(nobody, 2.0).starts_with("abort NOT CONFIRMED: no thruster driver answered within 2 s"));
  CHECK_FALSE(nobody.speaks(2.0));
  AbortWatch mute{kNumber, 0.0};
  mute.hear(answer("thruster_driver"));
  CHECK(told(mute, 2.0).find("nothing says on THRUSTERS") != std::string::npos);
  AbortWatch goes_on{kNumber, 0.0};
  goes_on.hear(answer("thruster_driver"));
  goes_on.hear(thrust(20.0));
  goes_on.hear(thrust(0.0));  // somebody says zero in between
  CHECK(told(goes_on, 2.0).find("THRUSTERS still says 20") != std::string::npos);
  AbortWatch dead{kNumber, 0.0};
  dead.hear(answer("thruster_driver"));
  three_zeros(dead, 0.5);
  CHECK_FALSE(dead.outcome(0.5 + AbortWatch::kVehicle - 0.1));
  CHECK(told(dead, 0.5 + AbortWatch::kVehicle).find("nothing is heard on VEHICLE") != std::string::npos);
  dead.hear(alive(false));
  CHECK(told(dead, 0.6).find("nobody knows what the vehicle does: no heartbeat for 20 s") != std::string::npos);
}

}  // namespace fathom::orders
