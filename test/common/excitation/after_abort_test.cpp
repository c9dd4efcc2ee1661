// What is flown after a trial that nobody ordered to end: zero thrust, the depth, or the surface, as the vehicle file
// says; and that the operator's zero is above all of it.
#include "common/model/after_abort.hpp"

#include <doctest/doctest.h>

#include <algorithm>

#include "test/common/excitation/supervisor_loop.hpp"

namespace fathom::excitation {
namespace {

using model::AfterAbort;

constexpr double kHeavy = 4.0;  // N of weight beyond the buoyancy

test::TankSettings heavy(const AfterAbort& after) {
  test::TankSettings settings = settings_without_model();
  for (std::size_t i = 0; i < settings.vehicle.parameters.size(); ++i) {
    if (settings.vehicle.parameters[i] == "W-B") settings.vehicle.priors[i].mean = kHeavy;
  }
  settings.supervisor.after_abort = after;
  settings.supervisor.patience = 3.0;
  return settings;
}

/// A heavy vehicle in the middle of an excitation.
struct Trial {
  Loop loop;

  explicit Trial(const AfterAbort& after) : loop{heavy(after)} {
    loop.run(0.2);
    loop.arm();
    loop.run(25.0);
    REQUIRE(loop.said->phase == "excite");
  }
  void leak() {
    VehicleCondition vehicle;
    vehicle.lines = {{"armed", true, false, "armed"}, {"failsafe", false, true, "the vehicle says 'Leak Detected'"}};
    loop.supervisor.hear(vehicle);
  }
  void abort() { loop.supervisor.hear(Operator{.utime = loop.plant.utime(), .abort = true}); }
  [[nodiscard]] double z() const { return loop.plant.position().z(); }
  [[nodiscard]] bool says(const char* words) const { return loop.supervisor.reason().find(words) != std::string::npos; }
};

AfterAbort hold() { return {.action = AfterAbort::Action::kHoldDepth, .largest = 10.0, .duration = 60.0}; }
AfterAbort surface(double blind = 0.0) {
  return {.action = AfterAbort::Action::kSurface, .speed = 0.1, .largest = 10.0, .duration = 60.0, .blind = blind};
}

}  // namespace

TEST_CASE("after an abort: without a word in the vehicle file the thrust is zero, and a heavy vehicle sinks") {
  Trial trial{AfterAbort{}};
  const double depth = trial.z();
  trial.leak();
  CHECK(trial.loop.supervisor.phase() == Phase::kAborted);
  CHECK(trial.loop.supervisor.reason() == "the vehicle says 'Leak Detected'");
  trial.loop.run(5.0);
  CHECK_FALSE(trial.loop.thrust());
  CHECK(trial.z() > depth + 0.2);
}

TEST_CASE("after an abort: the depth is held, and nothing but the vertical is commanded") {
  Trial trial{hold()};
  trial.leak();
  CHECK(trial.says("the vehicle says 'Leak Detected'; then: holds its depth, at most 60 s"));
  const double depth = trial.z();
  double farthest = 0.0;
  for (int i = 0; i < 40; ++i) {
    trial.loop.run(0.5);
    farthest = std::max(farthest, std::abs(trial.z() - depth));
    const Vector6d& tau = trial.loop.plant.applied().tau;
    CHECK(Vector6d(tau - tau[2] * Vector6d::Unit(2)).norm() < 0.6);  // the vertical thruster's lever arm, no more
  }
  CHECK(farthest < 0.15);
  CHECK(trial.loop.said->phase == "aborted");
}

TEST_CASE("after an abort: the surface is reached at the stated speed and stayed at, until the time is over") {
  Trial trial{surface()};
  const double top = trial.loop.settings.supervisor.surface;
  const double way = trial.z() - top;
  REQUIRE(way > 0.3);
  trial.leak();
  trial.loop.run(0.5 * way / 0.1);
  CHECK(trial.z() > top + 0.25 * way);  // not sooner
  trial.loop.run(way / 0.1 + 10.0);
  CHECK(std::abs(trial.z() - top) < 0.1);
  CHECK(trial.loop.thrust());
  trial.loop.run(60.0);
  CHECK_FALSE(trial.loop.thrust());
  CHECK(trial.says("zero thrust: 60 s of 'after_abort' are over"));
  trial.loop.run(2.0);
  CHECK(trial.loop.commands == 0);
}

TEST_CASE("after an abort: the operator's zero is above it, before and while it is flown") {
  Trial at_once{surface()};
  at_once.abort();
  at_once.loop.run(2.0);
  CHECK(at_once.loop.largest_command == 0.0);
  CHECK(at_once.loop.supervisor.reason() == "aborted by the operator");

  Trial later{hold()};
  later.leak();
  later.loop.run(3.0);
  REQUIRE(later.loop.thrust());
  later.abort();
  later.loop.run(0.1);
  CHECK_FALSE(later.loop.thrust());
  CHECK(later.loop.supervisor.reason() == "aborted by the operator");
  later.loop.run(5.0);
  CHECK(later.loop.largest_command == 0.0);
}

TEST_CASE("after an abort: where the depth is not known the trim remains, and a push upward where one is stated") {
  for (const double blind : {0.0, 3.0}) {
    CAPTURE(blind);
    Trial trial{surface(blind)};
    trial.loop.valid = false;
    trial.loop.run(3.3);  // without thrust for the patience
    REQUIRE(trial.loop.supervisor.phase() == Phase::kLost);
    trial.loop.run(1.0);
    CHECK(trial.says("the depth is not known"));
    // Up is negative; the trim that was found holds most of the weight.
    CHECK(trial.loop.plant.applied().tau[2] == doctest::Approx(-kHeavy - blind).epsilon(0.3));
    trial.loop.valid = true;
    trial.loop.run(1.0);
    CHECK_FALSE(trial.says("the depth is not known"));
  }
}

TEST_CASE("after an abort: a vehicle on its side is not pushed; one whose STATE has ceased gets no command") {
  DepthAction action{surface(), 0.1};
  Hold hold_depth{HoldSettings{.mass = 20.0}, Vector6d::Constant(10.0)};
  StateEstimate state{.utime = 1'000'000, .p_WB = {0, 0, 2.0}, .valid = true};
  action.begin(state);
  CHECK(action.step(state, hold_depth, 0.05)[2] != 0.0);
  state.q_WB = Eigen::Quaterniond{rotation_from_euler({1.5, 0.0, 0.0})};
  CHECK(action.step(state, hold_depth, 0.05).isZero());
  CHECK(action.text().find("lies on its side") != std::string::npos);

  Trial trial{hold()};
  trial.leak();
  trial.loop.run(2.0);
  trial.loop.heard = false;
  trial.loop.run(1.0);
  CHECK_FALSE(trial.loop.thrust());
}

TEST_CASE(
    "after an abort: a grave condition keeps from arming for as long as it is told, and arming ends what is flown") {
  Trial trial{hold()};
  trial.leak();
  trial.loop.run(1.0);
  trial.loop.arm();
  CHECK(trial.loop.supervisor.reason() == "not armed: the vehicle says 'Leak Detected'");
  trial.loop.run(1.0);
  CHECK(trial.loop.thrust());  // what was refused changes nothing
  trial.loop.supervisor.hear(VehicleCondition{});
  trial.loop.arm();
  trial.loop.run(1.0);
  CHECK(trial.loop.said->phase == "approach");
}

TEST_CASE("after an abort: a vehicle that is disarmed by other hands is not moved, nor when it is armed again there") {
  VehicleCondition disarmed{.armed = 0};
  disarmed.lines = {{"armed", false, false, "the vehicle is disarmed"}};
  const VehicleCondition armed{.armed = 1};
  Trial trial{surface()};
  trial.leak();
  trial.loop.run(1.0);
  REQUIRE(trial.loop.thrust());
  trial.loop.supervisor.hear(disarmed);
  trial.loop.supervisor.hear(armed);
  trial.loop.run(5.0);
  CHECK(trial.loop.largest_command == 0.0);
  CHECK(trial.says("zero thrust: the vehicle was disarmed"));

  Trial before{surface()};  // disarmed first, then the trial ends by it
  disarmed.lines[0].grave = true;
  before.loop.supervisor.hear(disarmed);
  CHECK(before.loop.supervisor.phase() == Phase::kAborted);
  before.loop.supervisor.hear(armed);
  before.loop.run(5.0);
  CHECK(before.loop.largest_command == 0.0);
}

}  // namespace fathom::excitation
