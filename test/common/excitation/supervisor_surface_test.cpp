// A trial that begins at the surface, as a vehicle that is put into the water does: armed afloat, down first, then in.
#include <doctest/doctest.h>

#include "common/excitation/supervisor.hpp"
#include "common/orders/words.hpp"
#include "test/common/excitation/supervisor_loop.hpp"

namespace fathom::excitation {
namespace {

constexpr double kAfloat = 0.10;  // m, z of Bo in the tank: the hull's top 27 mm above the water

/// A vehicle at this depth, armed there.
void armed_at(Loop& loop, double z) {
  loop.plant.place({0.6, -0.2, z});
  loop.run(0.05);
  loop.arm();
}

/// Runs with the vehicle kept at this depth, as air under its hull would.
void kept_at(Loop& loop, double z, double seconds) {
  for (double t = 0.0; t < seconds; t += 0.05) {
    loop.plant.place({0.6, -0.2, z});
    loop.run(0.05);
  }
}

void steer(Loop& loop, const Vector6d& tau) {
  Operator order = test::order_to_arm(loop.plant.utime());
  order.enable = false;
  order.order = "manual";
  order.tau = tau;
  loop.supervisor.hear(order);
}

}  // namespace

TEST_CASE("surface: a vehicle that floats is armed, goes down with no other thrust, and begins when it is below") {
  Loop loop;
  armed_at(loop, kAfloat);
  CHECK(loop.supervisor.phase() == Phase::kApproach);
  const double bound = loop.settings.supervisor.fence.low.z();
  double sideways = 0.0, longest = 0.0;
  while (loop.plant.position().z() < bound - 0.02 && longest < 10.0) {
    loop.run(0.01);
    longest += 0.01;
    for (const Eigen::Index axis : {0, 1, 5})
      sideways = std::max(sideways, std::abs(loop.plant.applied().tau[static_cast<std::size_t>(axis)]));
    if (longest > 0.2) CHECK(loop.said->reason.ends_with("floats: goes down first"));
  }
  CHECK(longest < 5.0);
  CHECK(sideways < 1e-9);
  loop.run(1.0);
  CHECK(loop.said->reason == "goes to where mode yaw begins");
  loop.run(25.0);
  CHECK_MESSAGE(loop.supervisor.phase() == Phase::kExcite, loop.supervisor.reason());
  // It began afloat once: whoever comes up in the trial has left the room.
  kept_at(loop, kAfloat, 0.2);
  CHECK(loop.supervisor.reason() == "left the envelope: too far up");
}

TEST_CASE("surface: asked before it is told that it floats; out of the water it is not armed, and lifted it stops") {
  Loop loop;
  const auto ask = [&](double z) {
    loop.plant.place({0.6, -0.2, z});
    loop.run(0.05);
    Operator order = test::order_to_arm(loop.plant.utime());
    order.enable = false;
    order.order = orders::kPreflight;
    return loop.supervisor.hear(order);
  };
  const Answer afloat = ask(kAfloat);
  CHECK(afloat.done);
  CHECK_MESSAGE(afloat.text.starts_with("floats, goes down first: at 0.6"), afloat.text);
  const Answer carried = ask(-0.3);
  CHECK_FALSE(carried.done);
  CHECK_MESSAGE(carried.text.starts_with("too far up: at "), carried.text);
  loop.arm();
  CHECK(loop.supervisor.reason() == "not armed: too far up");
  armed_at(loop, kAfloat);
  kept_at(loop, kAfloat - 0.05, 0.5);  // a wave
  CHECK(loop.supervisor.phase() == Phase::kApproach);
  kept_at(loop, kAfloat - 0.15, 0.5);  // hands
  CHECK(loop.supervisor.reason() == "left the envelope: too far up");
  CHECK(loop.largest_command == 0.0);
}

TEST_CASE("surface: a vehicle that does not come down is given up, with the reason") {
  Loop loop;
  armed_at(loop, kAfloat);
  kept_at(loop, kAfloat, loop.settings.supervisor.approach_time - 1.0);
  CHECK(loop.supervisor.phase() == Phase::kApproach);
  CHECK(loop.largest_command > 0.0);
  kept_at(loop, kAfloat, 2.0);
  CHECK(loop.supervisor.phase() == Phase::kAborted);
  CHECK_MESSAGE(loop.supervisor.reason().starts_with("did not come down from the surface in 15 s"),
                loop.supervisor.reason());
  CHECK(loop.largest_command == 0.0);
}

TEST_CASE("surface: by hand nothing moves before it is pushed down, and nothing when the key is let go") {
  Loop loop;
  armed_at(loop, kAfloat);
  Vector6d tau = Vector6d::Zero();
  tau << 8.0, -8.0, -5.0, 0.0, 0.0, 0.5;
  steer(loop, tau);
  kept_at(loop, kAfloat, 0.4);
  CHECK(loop.largest_command == 0.0);
  CHECK(loop.said->reason.ends_with("floats: no thrust but downward"));
  tau[2] = 6.0;
  steer(loop, tau);
  kept_at(loop, kAfloat, 0.4);
  CHECK(loop.largest_command == doctest::Approx(6.0));
  kept_at(loop, kAfloat, 20.0);  // let go; no matter how long
  CHECK(loop.largest_command == 0.0);
  CHECK(loop.supervisor.phase() == Phase::kHold);
  for (int i = 0; i < 40 && loop.plant.position().z() < loop.settings.supervisor.fence.low.z() + 0.05; ++i) {
    steer(loop, tau);
    loop.run(0.1);
  }
  CHECK_MESSAGE(std::abs(loop.plant.applied().tau[0]) > 1.0, loop.supervisor.reason());  // it is in its room
}

TEST_CASE("surface: a craft that does not dive is armed afloat and moves there") {
  test::TankSettings boat = settings_without_model();
  boat.vehicle.dof[2] = false;
  boat.supervisor.largest[2] = 0.0;
  std::erase_if(boat.supervisor.schedule, [](const Mode& mode) { return mode.axis == 2; });
  Loop loop{boat};
  armed_at(loop, 0.0);
  kept_at(loop, 0.0, 1.0);
  CHECK_MESSAGE(loop.supervisor.phase() == Phase::kApproach, loop.supervisor.reason());
  CHECK(loop.thrust());
  CHECK(loop.said->reason == "goes to where mode yaw begins");
  CHECK_FALSE(loop.said->bent);
  kept_at(loop, -0.8, 0.2);
  CHECK(loop.supervisor.reason() == "left the envelope: too far up");
}

}  // namespace fathom::excitation
