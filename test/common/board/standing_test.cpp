// The words at the top of the page: a trial that ended well is no trouble, one that was lost sight of is.
#include "common/board/standing.hpp"

#include <doctest/doctest.h>

namespace fathom::board {
namespace {

Roll::Entry process(const std::string& name, const std::string& state) {
  Roll::Entry entry{.health = {.process = name}, .state = state};
  entry.healthy = state == "running";
  return entry;
}

Excitation excitation(const std::string& phase, const std::string& mode = "") {
  return {.reason = "the reason", .mode = mode, .phase = phase};
}

}  // namespace

TEST_CASE("standing: after a good trial nothing is red, whether its processes have stopped or still run") {
  const Excitation done = excitation("done");
  const std::vector<Roll::Entry> stopped{process("board@topside:8077", "running"), process("estimator", "stopped"),
                                         process("supervisor", "stopped")};
  const Standing after = standing({.trial = &done, .trial_age = 40.0, .heard = 40.0, .processes = stopped});
  CHECK(after.phase.text == "done");
  CHECK(after.phase.kind == "good");
  CHECK(after.armed.text == "not armed");
  CHECK(after.armed.kind.empty());
  CHECK(after.alarm.empty());
  CHECK(after.remark == "every process has stopped in order, 40 s ago: all below is of then");
  CHECK(after.over);
  // Of a simulated trial the vehicle goes first: no STATE, no EXCITATION, and everybody else is there.
  const std::vector<Roll::Entry> running{process("estimator", "running"), process("supervisor", "running"),
                                         process("simulator", "stopped")};
  const Standing waits = standing({.trial = &done, .trial_age = 40.0, .heard = 0.5, .processes = running});
  CHECK(waits.phase.text == "done");
  CHECK(waits.armed.text == "not armed");
  CHECK(waits.alarm.empty());
  CHECK_FALSE(waits.over);
}

TEST_CASE("standing: what was armed and is not heard any more is red, and so is a supervisor that fell silent") {
  const Excitation excite = excitation("excite", "yaw"), done = excitation("done");
  const std::vector<Roll::Entry> running{process("supervisor", "running")}, silent{process("supervisor", "silent")},
      stopped{process("supervisor", "stopped")}, failed{process("supervisor", "fault")};
  const Standing lost = standing({.trial = &excite, .trial_age = 4.0, .heard = 0.5, .processes = running});
  CHECK(lost.phase.text == "was excite");
  CHECK(lost.phase.kind == "bad");
  CHECK(lost.armed.text == "armed? not known");
  CHECK(lost.armed.kind == "bad");
  const Standing quiet = standing({.trial = &done, .trial_age = 9.0, .heard = 9.0, .processes = silent});
  CHECK(quiet.phase.text == "was done");
  CHECK(quiet.armed.text == "armed? not known");
  CHECK(quiet.alarm == "nothing heard for 9.0 s: all below is of then");
  CHECK_FALSE(quiet.over);
  const Standing died = standing({.trial = &done, .trial_age = 9.0, .heard = 0.5, .processes = failed});
  CHECK(died.armed.kind == "bad");
  CHECK(died.alarm == "supervisor fault");
  // Stopped in the midst of it: no commands any more, and not a good end.
  const Standing cut = standing({.trial = &excite, .trial_age = 9.0, .heard = 9.0, .processes = stopped});
  CHECK(cut.phase.text == "was excite");
  CHECK(cut.phase.kind == "bad");
  CHECK(cut.armed.text == "not armed");
}

TEST_CASE("standing: while it is fresh, as it is said; who is not well is named once with the reason") {
  const Excitation excite = excitation("excite", "yaw"), aborted = excitation("aborted"),
                   waits = excitation("disarmed");
  std::vector<Roll::Entry> all{process("estimator", "unhealthy"), process("supervisor", "running")};
  all[0].detail = "AHRS is silent; DVL rejected 4; ";
  const Standing flying = standing({.trial = &excite, .trial_age = 0.1, .heard = 0.1, .processes = all});
  CHECK(flying.phase.kind == "go");
  CHECK(flying.armed.text == "armed");
  CHECK(flying.armed.kind == "warn");
  CHECK(flying.alarm == "estimator unhealthy: AHRS is silent");
  const Standing over = standing({.trial = &aborted, .trial_age = 0.1, .heard = 0.1, .processes = all});
  CHECK(over.alarm == "aborted: the reason; estimator unhealthy: AHRS is silent");
  CHECK(standing({.trial = &waits, .trial_age = 0.1, .heard = 0.1}).armed.text == "not armed");
  const Standing nothing = standing({});
  CHECK(nothing.phase.text == "no EXCITATION");
  CHECK(nothing.armed.text.empty());
  CHECK(nothing.alarm.starts_with("nothing heard on this bus yet"));
}

}  // namespace fathom::board
