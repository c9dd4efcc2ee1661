// The supervisor's rules of safety, each with what breaks it: arming, abort in every mode, loss of the estimate, the
// envelope, sick neighbours, skip.
#include "common/excitation/supervisor.hpp"

#include <doctest/doctest.h>

#include <limits>

#include "common/base/error.hpp"
#include "common/orders/words.hpp"
#include "test/common/excitation/supervisor_loop.hpp"
#include "test/support/scratch.hpp"

namespace fathom::excitation {

TEST_CASE("supervisor: nothing is commanded before the operator has armed, and not with a wrong, old or used order") {
  Loop loop;
  loop.run(2.0);
  CHECK(loop.commands == 0);
  CHECK(loop.said->phase == "disarmed");
  Operator wrong = order_to_arm(loop.plant.utime());
  wrong.authentic = false;
  CHECK(loop.supervisor.hear(wrong).text == "not signed with this vehicle's key");
  wrong = order_to_arm(loop.plant.utime());
  ++wrong.challenge;
  CHECK_FALSE(loop.supervisor.hear(wrong).done);
  Operator old = order_to_arm(loop.plant.utime() - 60'000'000);
  loop.supervisor.hear(old);
  loop.run(0.5);
  CHECK(loop.commands == 0);
  const Operator good = order_to_arm(loop.plant.utime());
  const Answer answer = loop.supervisor.hear(good);
  CHECK(answer.done);
  CHECK(answer.armed);
  CHECK(answer.sequence == good.sequence);
  loop.run(0.5);
  CHECK(loop.supervisor.hear(good).text == answer.text);  // said again, since its answer was lost
  CHECK(loop.commands > 5);
  const Operator kept = order_to_arm(loop.plant.utime());  // on its way when it is aborted
  loop.run(0.1);
  loop.supervisor.hear(Operator{.abort = true});
  CHECK(loop.supervisor.hear(kept).text.find("before the abort") != std::string::npos);
  loop.run(2.0);
  const Answer replayed = loop.supervisor.hear(good);
  CHECK_FALSE(replayed.done);
  CHECK_FALSE(replayed.armed);
  CHECK(replayed.text == "ended since: aborted by the operator");
  loop.run(0.5);
  CHECK(loop.supervisor.phase() == Phase::kAborted);
  CHECK_FALSE(loop.thrust());
  loop.arm();
  loop.run(0.5);
  CHECK(loop.thrust());
}

TEST_CASE("supervisor: it does not arm on an invalid state, outside of the envelope, or beside a sick process") {
  Loop loop;
  loop.valid = false;
  loop.run(0.5);
  loop.arm();
  loop.run(0.5);
  CHECK(loop.supervisor.reason() == "not armed: the state is not valid");
  loop.valid = true;
  loop.plant.place({2.45, 0.0, 0.75});
  loop.run(0.1);
  loop.arm();
  loop.run(0.2);
  CHECK(loop.supervisor.reason() == "not armed: too far north");
  loop.plant.place({0.0, 0.0, 0.75});
  loop.supervisor.hear(Health{.process = "identifier", .state = "unhealthy"});
  loop.run(0.1);
  loop.arm();
  loop.run(0.2);
  CHECK(loop.supervisor.reason() == "not armed: identifier is unhealthy; see to it, then arm again");
  loop.supervisor.hear(Health{.process = "identifier", .state = "running"});
  loop.arm();
  loop.run(0.2);
  CHECK(loop.commands > 0);
}

TEST_CASE("supervisor: asked before, it says whether it would arm at this place, and nothing is armed by that") {
  Loop loop;
  loop.run(0.5);
  const auto ask = [&] {
    Operator order = order_to_arm(loop.plant.utime());
    order.enable = false;
    order.order = orders::kPreflight;
    return loop.supervisor.hear(order);
  };
  const Answer inside = ask();
  CHECK(inside.done);
  CHECK_FALSE(inside.armed);
  CHECK_MESSAGE(inside.text.starts_with("at 0.2"), inside.text);
  CHECK(inside.text.find("below the surface") != std::string::npos);
  loop.run(0.5);
  CHECK(loop.commands == 0);
  CHECK(loop.supervisor.reason() == "waits for the operator to arm");
  loop.plant.place({2.45, 0.0, 0.75});
  loop.run(0.1);
  const Answer outside = ask();
  CHECK_FALSE(outside.done);
  CHECK_MESSAGE(outside.text.starts_with("too far north: at 2.45 m north"), outside.text);
  CHECK(outside.text.find("beyond the bound: north") != std::string::npos);
  loop.valid = false;
  loop.run(0.1);
  CHECK(ask().text == "the state is not valid");
}

TEST_CASE("supervisor: in open water it arms again wherever the vehicle has drifted since the last trial") {
  test::TankSettings open = settings_without_model();
  open.supervisor.fence.low.setConstant(-std::numeric_limits<double>::infinity());
  open.supervisor.fence.high.setConstant(std::numeric_limits<double>::infinity());
  Loop loop{open};
  loop.run(0.2);
  loop.arm();
  loop.run(1.0);
  CHECK(loop.commands > 0);
  loop.supervisor.hear(Operator{.abort = true});
  loop.run(2.0);
  loop.plant.place({3.0 * open.supervisor.open_range, 0.0, 0.75});
  loop.run(0.1);
  loop.arm();
  loop.run(1.0);
  CHECK_MESSAGE(loop.commands > 0, loop.supervisor.reason());
  CHECK_FALSE(loop.supervisor.reason().starts_with("not armed"));
}

TEST_CASE("supervisor: an order that arms another controller arms no supervisor") {
  Loop loop;
  loop.run(0.5);
  Operator order = order_to_arm(loop.plant.utime());
  order.order = orders::kOther;
  const Answer answer = loop.supervisor.hear(order);
  CHECK_FALSE(answer.done);
  CHECK_FALSE(answer.armed);
  loop.run(0.5);
  CHECK(loop.commands == 0);
}

TEST_CASE("supervisor: commands name the order that armed, those after a stop too, until the next arming") {
  Loop loop;
  loop.run(2.0);
  const Operator first = order_to_arm(loop.plant.utime());
  loop.supervisor.hear(first);
  loop.run(1.0);
  CHECK(loop.armed_by == first.sequence);
  loop.order("hold");  // allows nothing anew
  loop.run(1.0);
  CHECK(loop.armed_by == first.sequence);
  const Operator again = order_to_arm(loop.plant.utime());  // to thrusters that have lost the first
  loop.supervisor.hear(again);
  loop.run(1.0);
  CHECK(loop.armed_by == again.sequence);
  loop.supervisor.hear(Operator{.abort = true});
  loop.run(0.5);
  CHECK(loop.commands > 0);
  CHECK(loop.armed_by == again.sequence);
  loop.valid = false;
  loop.run(2.0);
  loop.arm();  // refused
  loop.run(1.0);
  CHECK(loop.commands == 0);
  loop.valid = true;
  const Operator last = order_to_arm(loop.plant.utime());
  loop.run(0.1);
  loop.supervisor.hear(last);
  loop.run(1.0);
  CHECK(loop.commands > 0);
  CHECK(loop.armed_by == last.sequence);
}

TEST_CASE(
    "supervisor: who has not heard whoever moves the thrusters believes no order, nor answers that nobody signed") {
  Loop loop;
  loop.supervisor = Supervisor{loop.settings.supervisor, loop.settings.vehicle};
  loop.run(0.5);
  CHECK(loop.supervisor.hear(order_to_arm(loop.plant.utime())).text == "no thruster driver has been heard");
  Answer gate{
      .utime = loop.plant.utime(), .gate = true, .challenge = test::kChallenge, .accepted = test::last_number()};
  loop.supervisor.hear(gate);
  CHECK_FALSE(loop.supervisor.hear(order_to_arm(loop.plant.utime())).done);
  gate.authentic = true;
  const Operator before = order_to_arm(loop.plant.utime());
  gate.accepted = before.sequence;  // it came late: that order was another's
  loop.supervisor.hear(gate);
  CHECK(loop.supervisor.hear(before).text == "heard before");
  CHECK(loop.supervisor.hear(order_to_arm(loop.plant.utime())).done);
}

TEST_CASE("supervisor: an operator who promised to stay is missed, and it aborts or stays where it is") {
  for (const bool holds : {false, true}) {
    CAPTURE(holds);
    Loop loop;
    loop.settings.supervisor.holds_without_operator = holds;
    loop.supervisor = test::ready(loop.settings.supervisor, loop.settings.vehicle);
    loop.run(0.2);
    Operator order = order_to_arm(loop.plant.utime());
    order.attends = 2.0;
    loop.supervisor.hear(order);
    for (int i = 0; i < 10; ++i) {
      loop.run(1.0);
      Operator sign = order_to_arm(loop.plant.utime());
      sign.enable = false;
      sign.order.clear();
      if (i < 8) CHECK(loop.supervisor.hear(sign).done);
      sign = order_to_arm(loop.plant.utime());  // somebody else's
      sign.authentic = false;
      loop.supervisor.hear(sign);
      CHECK(loop.said->phase != "aborted");
    }
    CHECK(loop.supervisor.reason().find("the operator is lost") == std::string::npos);
    loop.run(0.5);
    CHECK(loop.supervisor.reason().find("the operator is lost: no sign of life for 2 s") != std::string::npos);
    CHECK(loop.said->phase == (holds ? "hold" : "aborted"));
  }
  Loop alone;  // who promised nothing is not missed
  alone.run(0.2);
  alone.arm();
  alone.run(30.0);
  CHECK(alone.said->phase == "excite");
}

TEST_CASE("supervisor: where the operator must stay nobody arms who does not") {
  Loop loop;
  loop.settings.supervisor.wants_operator = true;
  loop.supervisor = test::ready(loop.settings.supervisor, loop.settings.vehicle);
  loop.run(0.2);
  CHECK(loop.supervisor.hear(order_to_arm(loop.plant.utime())).text.find("must stay") != std::string::npos);
  Operator order = order_to_arm(loop.plant.utime());
  order.attends = 5.0;
  CHECK(loop.supervisor.hear(order).done);
}

TEST_CASE("supervisor: an abort in every mode stops the thrusters at once") {
  for (const std::size_t skips : {0U, 1U, 2U, 3U, 4U}) {
    Loop loop;
    loop.run(0.2);
    loop.arm();
    loop.run(0.2);
    for (std::size_t i = 0; i < skips; ++i) {
      loop.order("skip");
      loop.run(0.2);
    }
    loop.run(20.0);
    CAPTURE(skips);
    CHECK(loop.said->mode == loop.settings.supervisor.schedule[skips].name);
    CHECK(loop.said->phase == "excite");
    loop.supervisor.hear(Operator{.abort = true});
    loop.run(0.06);
    CHECK_FALSE(loop.thrust());
    loop.run(3.0);
    CHECK(loop.commands <= 21);  // it says zero for a second, then nothing
    CHECK(loop.said->phase == "aborted");
    CHECK_FALSE(loop.thrust());
  }
}

TEST_CASE("supervisor: without a valid state there is no thrust; it goes on when it is back soon, else it disarms") {
  Loop loop;
  loop.run(0.2);
  loop.arm();
  loop.run(20.0);
  CHECK(loop.said->phase == "excite");
  loop.valid = false;
  loop.run(0.06);
  CHECK_FALSE(loop.thrust());
  loop.run(1.0);
  CHECK(loop.said->phase == "lost");
  loop.valid = true;
  loop.run(0.1);
  CHECK(loop.said->phase == "approach");  // first back to where the mode begins
  CHECK(loop.thrust());
  loop.valid = false;
  loop.run(loop.settings.supervisor.patience + 0.5);
  CHECK(loop.supervisor.phase() == Phase::kLost);
  loop.valid = true;
  loop.run(2.0);
  CHECK_FALSE(loop.thrust());
}

TEST_CASE("supervisor: beside a sick process there is no thrust; it goes on when that is well soon, else it aborts") {
  Loop loop;
  loop.run(0.2);
  loop.arm();
  loop.run(20.0);
  CHECK(loop.said->phase == "excite");
  loop.supervisor.hear(Health{.process = "estimator", .state = "unhealthy"});
  loop.run(0.06);
  CHECK_FALSE(loop.thrust());
  loop.run(1.0);
  CHECK(loop.said->phase == "lost");
  loop.supervisor.hear(Health{.process = "estimator", .state = "running"});
  loop.run(0.1);
  CHECK(loop.said->phase == "approach");
  CHECK(loop.thrust());
  loop.supervisor.hear(Health{.process = "estimator", .state = "unhealthy"});
  loop.run(loop.settings.supervisor.patience + 0.5);
  CHECK(loop.supervisor.phase() == Phase::kAborted);
  CHECK(loop.supervisor.reason() == "estimator is unhealthy; see to it, then arm again");

  for (const bool back : {true, false}) {  // a deputy starts it again
    CAPTURE(back);
    Loop dead;
    dead.run(0.2);
    dead.arm();
    dead.run(20.0);
    dead.supervisor.hear(Health{.process = "estimator", .state = "fault", .detail = "no more memory"});
    dead.run(0.06);
    CHECK_FALSE(dead.thrust());
    CHECK(dead.said->reason == "no thrust: estimator is fault: no more memory");
    dead.run(3.0);
    if (back) dead.supervisor.hear(Health{.process = "estimator", .state = "running"});
    dead.run(dead.settings.supervisor.patience);
    CHECK((dead.supervisor.phase() == Phase::kAborted) == !back);
    CHECK(dead.thrust() == back);
  }
}

TEST_CASE("supervisor: when states stop coming the last command dies by itself") {
  Loop loop;
  loop.run(0.2);
  loop.arm();
  loop.run(20.0);
  CHECK(loop.thrust());
  loop.heard = false;
  loop.run(0.4);
  CHECK_FALSE(loop.thrust());
}

TEST_CASE(
    "supervisor: outside of the envelope, with numbers that are none, and beside a process that fails, it stops") {
  Loop pushed;
  pushed.run(0.2);
  pushed.arm();
  pushed.run(5.0);
  pushed.plant.place({2.4, 0.0, 0.75});
  pushed.run(0.1);
  CHECK(pushed.supervisor.phase() == Phase::kAborted);
  CHECK(pushed.supervisor.reason() == "left the envelope: too far north");
  CHECK_FALSE(pushed.thrust());

  Loop sick;
  sick.run(0.2);
  sick.arm();
  sick.run(5.0);
  sick.supervisor.hear(Health{.process = "camera_driver", .state = "fault"});  // not among those it needs
  sick.run(0.2);
  CHECK(sick.thrust());
  sick.supervisor.hear(Health{.process = "estimator", .state = "fault"});
  sick.run(0.1);
  CHECK_FALSE(sick.thrust());
  sick.run(sick.settings.supervisor.patience);
  CHECK(sick.supervisor.reason() ==
        "estimator is fault; start it, the sheriff's table tells why it does not run; then arm again");

  Loop broken;
  broken.run(0.2);
  broken.arm();
  StateEstimate nothing{.utime = broken.plant.utime() + 1, .valid = true};
  nothing.nu[0] = std::numeric_limits<double>::quiet_NaN();
  CHECK_FALSE(broken.supervisor.step(nothing).command.has_value());
}

TEST_CASE("supervisor: what cannot work is refused in one line") {
  const auto settings = test::tank_settings();
  auto rolling = settings.supervisor;
  rolling.schedule = {{.name = "roll", .axis = 3, .threshold = 1.0}};
  CHECK(test::complaint_of<InputError>([&] {
          Supervisor none(rolling, settings.vehicle);
        }).find("cannot move in mode roll") != std::string::npos);
}

}  // namespace fathom::excitation
