// The gate that lets a command pass to the thrusters: every rule, and what breaks it.
#include <doctest/doctest.h>

#include <cmath>
#include <string>

#include "common/driver/thruster_gate.hpp"
#include "common/orders/words.hpp"

using namespace fathom;
using namespace fathom::driver;

namespace {

constexpr Utime kStart = 1'700'000'000'000'000;
constexpr std::int64_t kChallenge = 4711;  // the driver's challenge

Utime at(double seconds) { return utime_after(kStart, seconds); }

/// An order's number: hundredths of seconds, so that each has its own.
std::int64_t number(double seconds) { return std::llround(100.0 * seconds); }

/// Of a commander that was armed at kArmed, or at another time.
constexpr double kArmed = 0.5;
WrenchCommand surge(double seconds, const std::string& commander = "supervisor", double armed = kArmed) {
  WrenchCommand command{.utime = at(seconds),
                        .life = 0.5,
                        .commander = commander,
                        .armed_by = number(armed),
                        .challenge = kChallenge,
                        .sequence = std::llround(1e4 * seconds),
                        .authentic = true};
  command.tau(0) = 10.0;
  return command;
}

Operator arm(double seconds) {
  return {
      .utime = at(seconds), .sequence = number(seconds), .challenge = kChallenge, .enable = true, .authentic = true};
}

}  // namespace

TEST_CASE("gate: who commands before the operator has armed, or without having been armed, is never obeyed") {
  for (const double claimed : {0.0, 1e6, 6.0}) {  // of no order, or of one that never was
    CAPTURE(claimed);
    ThrusterGate gate{kChallenge};
    const auto stray = [&](double now) {
      WrenchCommand command = surge(now, "stray", claimed);
      if (claimed == 0.0) command.armed_by = 0;
      gate.hear(command, at(now));
      CHECK(gate.wrench(at(now)).isZero());
    };
    CHECK(gate.wrench(at(0.0)).isZero());
    for (int i = 1; i <= 60; ++i) {  // with a pause in between
      if (i > 20 && i < 40) continue;
      stray(0.1 * i);
      CHECK(gate.reason(at(0.1 * i)) == "not armed");
    }
    gate.hear(arm(6.05), at(6.05));
    CHECK(gate.wrench(at(6.05)).isZero());          // what was asked before is not taken up
    for (int i = 61; i <= 80; ++i) stray(0.1 * i);  // the supervisor has refused, and is silent
    CHECK(std::string{gate.reason(at(8.0))}.find("was not armed") != std::string::npos);
    CHECK(gate.hears_stranger(at(8.0)));
    for (int i = 81; i <= 100; ++i) {  // beside one that was armed
      gate.hear(surge(0.1 * i, "supervisor", 6.05), at(0.1 * i));
      CHECK(gate.wrench(at(0.1 * i))(0) == 10.0);
      gate.hear(surge(0.1 * i + 0.05, "stray", claimed), at(0.1 * i + 0.05));
      CHECK(gate.wrench(at(0.1 * i + 0.05))(0) == 10.0);
      CHECK(gate.hears_stranger(at(0.1 * i + 0.05)));
    }
    for (int i = 106; i <= 140; ++i) stray(0.1 * i);  // it has stopped, or died
    gate.hear(arm(14.1), at(14.1));
    for (int i = 142; i <= 160; ++i) stray(0.1 * i);
    CHECK_FALSE(gate.hears_stranger(at(17.0)));  // when it is gone
  }
}

TEST_CASE("gate: an order that the commander did not hear leaves it obeyed, and a new arming does not stop it") {
  ThrusterGate gate{kChallenge};
  gate.hear(arm(kArmed), at(kArmed));
  gate.hear(surge(1.0), at(1.0));
  gate.hear(arm(1.05), at(1.05));  // "identify", said again
  CHECK(gate.wrench(at(1.06))(0) == 10.0);
  gate.hear(surge(1.1), at(1.1));
  CHECK(gate.wrench(at(1.1))(0) == 10.0);
  gate.hear(surge(1.2, "supervisor", 1.05), at(1.2));
  CHECK(gate.wrench(at(1.2))(0) == 10.0);
  gate.hear(arm(3.0), at(3.0));  // after a silence the old order is over
  gate.hear(surge(3.1), at(3.1));
  CHECK(gate.wrench(at(3.1)).isZero());
}

TEST_CASE("gate: a command is obeyed until half a second after the last, or for its life if that is shorter") {
  ThrusterGate gate{kChallenge};
  gate.hear(arm(kArmed), at(kArmed));
  CHECK(gate.reason(at(0.6)) == "no command");
  gate.hear(surge(1.0), at(1.0));
  CHECK(gate.wrench(at(1.49))(0) == 10.0);
  CHECK(gate.wrench(at(1.51)).isZero());
  CHECK(gate.reason(at(1.51)) == "commands have stopped");
  WrenchCommand command = surge(2.0);
  command.life = 0.1;
  gate.hear(command, at(2.0));
  CHECK(gate.wrench(at(2.05))(0) == 10.0);
  CHECK(gate.wrench(at(2.15)).isZero());
}

TEST_CASE("gate: a command of another time and numbers that are none are refused") {
  ThrusterGate gate{kChallenge};
  gate.hear(arm(kArmed), at(kArmed));
  gate.hear(surge(1.0), at(3.0));
  CHECK(gate.reason(at(3.0)) == "commands are not of now");
  gate.hear(surge(3600.0), at(3.1));
  CHECK(gate.wrench(at(3.1)).isZero());
  WrenchCommand command = surge(4.0);
  command.sequence = number(1e6);
  command.tau(1) = std::nan("");
  gate.hear(command, at(4.0));
  CHECK(gate.wrench(at(4.0)).isZero());
}

TEST_CASE(
    "gate: an order that nobody signed, heard before, of another life or of another time does not arm, and is "
    "counted") {
  ThrusterGate gate{kChallenge};
  const auto refused = [&](const Operator& order, double now, const char* why) {
    const auto before = gate.refused();
    const Answer answer = gate.hear(order, at(now));
    CHECK_FALSE(gate.armed());
    CHECK_FALSE(answer.done);
    CHECK(answer.sequence == order.sequence);
    CHECK(answer.text == gate.refusal());
    CHECK(gate.refused() == before + 1);
    CHECK(std::string{gate.refusal()}.find(why) != std::string::npos);
  };
  Operator guess = arm(1.0);
  guess.authentic = false;
  refused(guess, 1.0, "not signed");
  Operator before = arm(1.0);
  before.challenge = 4710;
  refused(before, 1.0, "started again");
  refused(arm(1.0), 100.0, "not of this time");  // a log played back
  refused(arm(9.0), 1.0, "not of this time");
  const Operator good = arm(2.0);
  CHECK(gate.hear(good, at(2.0)).done);
  CHECK(gate.armed());
  CHECK(gate.hear(good, at(2.1)).text == "armed");  // again, since its answer was lost
  gate.hear(Operator{.utime = at(2.5), .abort = true}, at(2.5));
  CHECK_FALSE(gate.hear(good, at(3.0)).done);  // the same message again, within its time
  CHECK_FALSE(gate.armed());
  Operator other = arm(2.0);
  other.utime = at(2.01);
  refused(other, 3.0, "before");
  ThrusterGate successor{kChallenge + 1};  // of a driver that has died .8 s after it was armed
  CHECK_FALSE(successor.hear(good, at(2.8)).done);
  CHECK_FALSE(successor.armed());
}

TEST_CASE("gate: commands that nobody signed or that are played again move nothing, stop nothing, and are named") {
  ThrusterGate gate{kChallenge};
  gate.hear(arm(kArmed), at(kArmed));
  double t = 1.0;
  for (int i = 0; i < 100; ++i, t += 0.05) {
    const WrenchCommand good = surge(t);
    gate.hear(good, at(t));
    WrenchCommand forged = good;  // every field copied but the signature
    forged.tau(0) = 100.0;
    ++forged.sequence;
    forged.authentic = false;
    gate.hear(forged, at(t + 0.01));
    CHECK(gate.wrench(at(t + 0.01))(0) == 10.0);
    gate.hear(good, at(t + 0.02));  // the same again, and an old one
    gate.hear(surge(1.0), at(t + 0.02));
    CHECK(gate.wrench(at(t + 0.02))(0) == 10.0);
  }
  CHECK(gate.hears_forgeries(at(t)));
  CHECK(gate.forgeries() ==
        "forged commands refused: 100 not signed with this vehicle's key, 200 replayed, the last in the name of "
        "'supervisor'");
  CHECK_FALSE(gate.hears_forgeries(at(t + 1.0)));
  WrenchCommand rude = surge(t, "\x1b[2J");
  rude.authentic = false;
  gate.hear(rude, at(t));
  CHECK(gate.forgeries().ends_with("'?[2J'"));
  ThrusterGate alone{kChallenge};  // forged commands to one whom nobody commands
  alone.hear(arm(kArmed), at(kArmed));
  for (double now = 1.0; now < 2.0; now += 0.005) {
    WrenchCommand forged = surge(now);
    forged.authentic = false;
    alone.hear(forged, at(now));
    CHECK(alone.wrench(at(now)).isZero());
  }
  CHECK_FALSE(alone.ignores(at(2.0)));  // it stops no trial
}

TEST_CASE("gate: a log player cannot move the vehicle, not even while it is armed") {
  // Recorded an hour ago: an operator who arms, and commands.
  ThrusterGate gate{kChallenge};
  const auto replay = [&](double now) {
    for (int i = 0; i < 50; ++i) {
      gate.hear(arm(-3600.0 + 0.02 * i), at(now + 0.02 * i));
      gate.hear(surge(-3600.0 + 0.02 * i, "supervisor of then"), at(now + 0.02 * i));
      CHECK(gate.wrench(at(now + 0.02 * i)).isZero());
    }
  };
  replay(0.0);
  gate.hear(arm(2.0), at(2.0));
  replay(2.0);
}

TEST_CASE("gate: of two that were armed by one order none is obeyed, and the second never takes over") {
  ThrusterGate gate{kChallenge};
  gate.hear(arm(kArmed), at(kArmed));
  for (int i = 0; i < 20; ++i) {
    gate.hear(surge(1.0 + 0.05 * i), at(1.0 + 0.05 * i));
    CHECK(gate.wrench(at(1.0 + 0.05 * i))(0) == 10.0);
  }
  for (int i = 0; i < 20; ++i) {
    gate.hear(surge(2.0 + 0.05 * i, "stranger"), at(2.0 + 0.05 * i));
    gate.hear(surge(2.0 + 0.05 * i), at(2.0 + 0.05 * i));
    CHECK(gate.wrench(at(2.0 + 0.05 * i)).isZero());
  }
  gate.hear(surge(4.0), at(4.0));  // alone again
  CHECK(gate.wrench(at(4.0))(0) == 10.0);
  for (int i = 0; i < 40; ++i) {  // the first one dies, the stranger goes on
    gate.hear(surge(5.0 + 0.05 * i, "stranger"), at(5.0 + 0.05 * i));
    CHECK(gate.wrench(at(5.0 + 0.05 * i)).isZero());
  }
  gate.hear(arm(9.5), at(9.5));  // the operator knows of the successor
  gate.hear(surge(9.6, "successor", 9.5), at(9.6));
  CHECK(gate.wrench(at(9.6))(0) == 10.0);
}

TEST_CASE("gate: an abort needs no key, is at once, and holds until it is armed again") {
  ThrusterGate gate{kChallenge};
  gate.hear(arm(kArmed), at(kArmed));
  gate.hear(surge(1.0), at(1.0));
  gate.hear(Operator{.abort = true}, at(1.1));
  CHECK(gate.wrench(at(1.1)).isZero());
  gate.hear(surge(1.2), at(1.2));
  CHECK(gate.wrench(at(1.2)).isZero());
  gate.hear(surge(3.0), at(3.0));  // a pause does not end an abort
  CHECK(gate.wrench(at(3.0)).isZero());
  gate.hear(arm(3.1), at(3.1));
  CHECK(gate.wrench(at(3.1)).isZero());  // nor is the old command taken up again
  gate.hear(surge(3.15), at(3.15));      // of the arming before
  CHECK(gate.wrench(at(3.15)).isZero());
  gate.hear(surge(3.2, "supervisor", 3.1), at(3.2));
  CHECK(gate.wrench(at(3.2))(0) == 10.0);
}

TEST_CASE("gate: an order to arm that was given before an abort and comes after it does not arm") {
  ThrusterGate gate{kChallenge};
  gate.hear(arm(kArmed), at(kArmed));
  gate.hear(surge(1.0), at(1.0));
  gate.hear(Operator{.abort = true}, at(2.0));
  const Answer late = gate.hear(arm(1.9), at(2.1));  // it was lost, and is said again; or somebody kept it back
  CHECK_FALSE(late.done);
  CHECK(late.text.find("before the abort") != std::string::npos);
  CHECK_FALSE(gate.armed());
  gate.hear(surge(2.2, "supervisor", 1.9), at(2.2));
  CHECK(gate.wrench(at(2.2)).isZero());
  CHECK(gate.hear(arm(2.5), at(2.5)).done);
}

TEST_CASE(
    "gate: what the supervisor refuses is armed no more, unless somebody is obeyed or another controller was armed") {
  const auto refusal = [](const Operator& order) {
    return Answer{.challenge = kChallenge, .sequence = order.sequence, .text = "outside", .authentic = true};
  };
  ThrusterGate gate{kChallenge};
  const Operator order = arm(1.0);
  CHECK(gate.hear(order, at(1.0)).armed);
  Answer other = refusal(order);  // none of these is the supervisor's refusal of this order
  other.authentic = false;
  CHECK_FALSE(gate.hear(other, at(1.05)));
  other = refusal(order);
  other.gate = true;
  CHECK_FALSE(gate.hear(other, at(1.05)));
  other = refusal(order);
  other.armed = true;
  CHECK_FALSE(gate.hear(other, at(1.05)));
  CHECK_FALSE(gate.hear(refusal(arm(0.9)), at(1.05)));
  CHECK(gate.armed());
  CHECK(gate.hear(refusal(order), at(1.05)));
  CHECK_FALSE(gate.armed());
  CHECK(gate.reason(at(1.1)) == "not armed: the supervisor refused");
  const Answer again = gate.hear(order, at(1.2));  // the console says it again
  CHECK_FALSE(again.done);
  CHECK(again.text == "not armed: the supervisor refused");
  gate.hear(surge(1.3, "supervisor", 1.0), at(1.3));
  CHECK(gate.wrench(at(1.3)).isZero());
  CHECK(gate.hear(arm(2.0), at(2.0)).armed);
  CHECK(gate.reason(at(2.0)) == "no command");

  ThrusterGate flying{kChallenge};  // what follows a trial is flown on, as before the refused order
  flying.hear(arm(kArmed), at(kArmed));
  flying.hear(surge(1.0), at(1.0));
  const Operator late = arm(1.1);
  flying.hear(late, at(1.1));
  CHECK_FALSE(flying.hear(refusal(late), at(1.2)));
  flying.hear(surge(1.25), at(1.25));
  CHECK(flying.wrench(at(1.25))(0) == 10.0);

  ThrusterGate another{kChallenge};
  Operator foreign = arm(1.0);
  foreign.order = orders::kOther;
  another.hear(foreign, at(1.0));
  CHECK_FALSE(another.hear(refusal(foreign), at(1.05)));
  another.hear(surge(1.1, "a controller of another", 1.0), at(1.1));
  CHECK(another.wrench(at(1.1))(0) == 10.0);
}

TEST_CASE("gate: who asks for thrust in vain is told, until it is armed; what is on its way at an abort is not meant") {
  ThrusterGate successor{kChallenge};  // of a driver that had been armed
  double t = 1.0;
  for (; t < 1.2; t += 0.05) successor.hear(surge(t), at(t));
  CHECK_FALSE(successor.ignores(at(t)));
  for (; t < 1.5; t += 0.05) successor.hear(surge(t), at(t));
  CHECK(successor.ignores(at(t)));
  for (; t < 2.5; t += 0.05) {  // the supervisor waits with zeros
    WrenchCommand zero = surge(t);
    zero.tau.setZero();
    successor.hear(zero, at(t));
  }
  CHECK(successor.ignores(at(t)));
  CHECK_FALSE(successor.ignores(at(t + 1.0)));  // and then gives up
  successor.hear(surge(t), at(t));
  CHECK(successor.ignores(at(t)));
  successor.hear(arm(t), at(t));
  CHECK_FALSE(successor.ignores(at(t)));
  successor.hear(surge(t + 0.1, "supervisor", t), at(t + 0.1));
  CHECK(successor.wrench(at(t + 0.1))(0) == 10.0);
  successor.hear(Operator{.abort = true}, at(t + 0.2));
  successor.hear(surge(t + 0.21), at(t + 0.21));
  CHECK_FALSE(successor.ignores(at(t + 0.3)));

  ThrusterGate replayed{kChallenge};  // commands of another time ask for nothing now
  for (double s = 0.0; s < 2.0; s += 0.05) replayed.hear(surge(s), at(1000.0 + s));
  CHECK_FALSE(replayed.ignores(at(1002.0)));
}
