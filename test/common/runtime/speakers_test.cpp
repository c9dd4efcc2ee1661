// Whose HEALTH is believed: a process's own words in their order; nobody's who is dead or was never there.
#include "common/runtime/speakers.hpp"

#include <doctest/doctest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <fathom_lcm/health_t.hpp>

#include "test/support/sleeper.hpp"

namespace fathom::runtime {
namespace {

using test::Sleeper;

fathom_lcm::health_t word(const std::string& host, std::int32_t pid, std::int64_t start, std::int64_t sequence) {
  fathom_lcm::health_t health{};
  health.process = "estimator";
  health.host = host;
  health.pid = pid;
  health.start = start;
  health.sequence = sequence;
  health.state = "running";
  return health;
}

}  // namespace

TEST_CASE("speakers: the kernel tells when a process began, and that there is none") {
  const auto own = process_start(getpid());
  REQUIRE(own);
  CHECK(*own > 0);
  CHECK(process_start(getpid()) == own);
  Sleeper other;
  CHECK(other.start >= *own);
  kill(other.pid, SIGKILL);
  siginfo_t info{};
  waitid(P_PID, static_cast<id_t>(other.pid), &info, WEXITED | WNOWAIT);
  CHECK_FALSE(process_start(other.pid));  // ended, not yet waited for
  other.end();
  CHECK_FALSE(process_start(other.pid));
  CHECK_FALSE(process_start(0));
  CHECK_FALSE(process_start(-1));
}

TEST_CASE("speakers: of this host a process that is there, with its own start, each word once") {
  Speakers speakers{"vehicle", Speakers::Home::kAnywhere};
  Sleeper one;
  CHECK(speakers.believes(word("vehicle", one.pid, one.start, 1)));
  CHECK(speakers.believes(word("vehicle", one.pid, one.start, 2)));
  CHECK_FALSE(speakers.believes(word("vehicle", one.pid, one.start, 2)));  // a recording of it
  CHECK_FALSE(speakers.believes(word("vehicle", one.pid, one.start, 1)));
  CHECK_FALSE(speakers.believes(word("vehicle", one.pid, one.start - 10'000, 3)));  // of its number, a process before
  one.end();
  CHECK_FALSE(speakers.believes(word("vehicle", one.pid, one.start, 3)));  // said in its name
  auto last = word("vehicle", one.pid, one.start, 4);
  last.state = "stopped";
  CHECK(speakers.believes(last));  // comes when it has gone
}

TEST_CASE("speakers: of other hosts what is new; a name of this host is no other host's where that is asked for") {
  Speakers any{"vehicle", Speakers::Home::kAnywhere}, first{"vehicle", Speakers::Home::kFirst};
  Sleeper one;
  for (Speakers* each : {&any, &first}) {
    CHECK(each->believes(word("topside", 7, 5, 1)));
    CHECK_FALSE(each->believes(word("topside", 7, 5, 1)));
    CHECK(each->believes(word("vehicle", one.pid, one.start, 1)));
  }
  CHECK(any.believes(word("topside", 7, 5, 2)));
  CHECK_FALSE(first.believes(word("topside", 7, 5, 2)));
  Speakers log{"", Speakers::Home::kFirst};  // nobody can be asked
  CHECK(log.believes(word("vehicle", 999'999'999, 5, 1)));
}

TEST_CASE("speakers: names that somebody makes up are forgotten, and do not fill the memory") {
  Speakers speakers{"vehicle", Speakers::Home::kFirst};
  for (int i = 1; i < 5000; ++i) CHECK(speakers.believes(word("made up " + std::to_string(i), i, 1, 1)));
  CHECK_FALSE(speakers.believes(word("made up 4999", 4999, 1, 1)));
}

}  // namespace fathom::runtime
