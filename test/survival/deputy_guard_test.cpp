// A deputy that obeys anybody is a shell for whoever reaches the bus: what --allow, a bus of its own and systemd's unit
// keep it from.
#include <doctest/doctest.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <array>
#include <csignal>
#include <string>
#include <thread>

#include "common/link/server.hpp"
#include "test/support/bus.hpp"
#include "test/support/private_network.hpp"

namespace fathom {
namespace {

using test::on_a_network;
using test::private_network;
using test::Scratch;

constexpr char kGood[] =
    "cmd \"sleeper\" { exec = \"sleep 1000\"; deputy = \"vehicle\"; }\n"
    "script \"go\" { start cmd \"sleeper\" wait \"running\"; }\n";
/// What a stranger orders: another program, and another line under a name that is allowed.
constexpr char kEvil[] =
    "cmd \"shell\" { exec = \"bash -c 'touch taken'\"; deputy = \"vehicle\"; }\n"
    "cmd \"sleeper\" { exec = \"touch taken\"; deputy = \"vehicle\"; }\n"
    "script \"shell\" { start cmd \"shell\" wait \"stopped\"; }\n"
    "script \"sleeper\" { start cmd \"sleeper\" wait \"stopped\"; }\n";

/// systemd's side of sd_notify(3).
class Manager {
 public:
  explicit Manager(const std::string& path) : socket_{socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0)} {
    sockaddr_un here{};
    here.sun_family = AF_UNIX;
    path.copy(here.sun_path, sizeof here.sun_path - 1);
    REQUIRE(bind(socket_, reinterpret_cast<const sockaddr*>(&here), sizeof here) == 0);
  }
  ~Manager() { close(socket_); }
  Manager(const Manager&) = delete;
  Manager& operator=(const Manager&) = delete;

  /// How many of these words come within so long; ends with the first when `first`.
  int hear(const std::string& word, double seconds, bool first = false) const {
    int count = 0;
    for (const double end = link::wall_seconds() + seconds; link::wall_seconds() < end && !(first && count > 0);) {
      std::array<char, 1000> text{};
      const ssize_t length = recv(socket_, text.data(), text.size(), MSG_DONTWAIT);
      if (length < 0) std::this_thread::sleep_for(std::chrono::milliseconds{5});
      if (length > 0 && std::string{text.data(), static_cast<std::size_t>(length)}.starts_with(word)) ++count;
    }
    return count;
  }

 private:
  int socket_;
};

}  // namespace

TEST_CASE("launch: with --allow a deputy runs no command line that its own file does not have, and --status says so") {
  if (!private_network()) return;
  const Scratch scratch;
  test::write_bytes(scratch.path("good.cfg"), kGood);
  test::write_bytes(scratch.path("evil.cfg"), kEvil);
  const auto ran =
      on_a_network(scratch,
                   "vehicle --allow good.cfg\n"
                   "for i in shell sleeper; do $sheriff evil.cfg --script $i; echo \"evil $?\"; done; ls taken\n"
                   "$sheriff good.cfg --script go; echo \"good $?\"\n"
                   "$sheriff good.cfg --status; kill $d; wait $d\n"
                   "vehicle; $sheriff good.cfg --status; kill $d; wait $d\n"
                   "FATHOM_ALLOW=good.cfg $deputy -i topside; echo \"topside $?\"\n");
  CHECK_MESSAGE(ran.says("shell on vehicle failed: exit 126"), ran.text);
  CHECK(ran.says("refused: this command line is not in good.cfg (--allow) on this host"));
  CHECK(ran.says("sleeper on vehicle failed: exit 126"));
  CHECK_FALSE(ran.says("evil 0"));
  CHECK(ran.says("cannot access 'taken'"));
  CHECK(ran.says("good 0"));
  CHECK(ran.says("vehicle: command lines: only the 1 of good.cfg"));
  CHECK(ran.says("vehicle: command lines: any that is ordered (no --allow)"));
  CHECK(ran.says("good.cfg: has no command for deputy 'topside'"));
  CHECK(ran.says("topside 1"));
}

TEST_CASE("launch: a sheriff's own deputies run its file alone") {
  if (!private_network()) return;
  const Scratch scratch;
  test::write_bytes(scratch.path("good.cfg"), kGood);
  test::write_bytes(scratch.path("evil.cfg"), kEvil);
  const auto ran = on_a_network(scratch,
                                "$sheriff good.cfg --script go --local --stay >sheriff.txt & s=$!\n"
                                "runs() { grep -q 'sleeper.* running' sheriff.txt; }; within 20 runs\n"
                                "$sheriff evil.cfg --script shell; echo \"evil $?\"; ls taken; kill $s; wait $s\n");
  CHECK_MESSAGE(ran.says("shell on vehicle failed: exit 126"), ran.text);
  CHECK(ran.says("cannot access 'taken'"));
}

TEST_CASE("launch: orders on a bus of their own are obeyed there alone; the programs have theirs") {
  if (!private_network()) return;
  const Scratch scratch;
  test::write_bytes(scratch.path("x.cfg"),
                    "cmd \"tell\" { exec = \"bash -c 'printenv LCM_DEFAULT_URL >bus.txt'\"; deputy = \"vehicle\"; }\n"
                    "script \"go\" { start cmd \"tell\" wait \"stopped\"; }\n");
  const auto ran =
      on_a_network(scratch,
                   "own='udpm://239.255.76.68:7668?ttl=0'\n"
                   "vehicle -u $own\n"
                   "$sheriff x.cfg --script go; echo \"other bus $?\"; ls bus.txt\n"
                   "$sheriff x.cfg --script go -u $own; echo \"own bus $?\"; cat bus.txt; kill $d; wait $d\n");
  CHECK_MESSAGE(ran.says("other bus 1"), ran.text);
  CHECK(ran.says("cannot access 'bus.txt'"));
  CHECK(ran.says("own bus 0"));
  CHECK(ran.says("udpm://239.255.76.67:7667?ttl=0"));
}

TEST_CASE("launch: systemd hears that a deputy is ready and goes on, and nothing while it hangs") {
  const Scratch scratch;
  const Manager systemd{scratch.path("notify")};
  const test::Bus bus;
  const std::string url = "LCM_DEFAULT_URL='" + bus.url + "' ";
  const test::Background deputy{scratch, "deputy",
                                url + "NOTIFY_SOCKET=" + scratch.path("notify") + " WATCHDOG_USEC=400000 " +
                                    test::program("deputy") + " -i notified"};
  const int pid = std::stoi(test::read_bytes(scratch.path("deputy.pid")));
  CHECK(systemd.hear("READY=1\nSTATUS=notified waits for orders; command lines: any", 10.0, true) == 1);
  CHECK(systemd.hear("WATCHDOG=1", 2.0) >= 5);  // ten are due: a machine may be slow
  kill(pid, SIGSTOP);
  (void)systemd.hear("WATCHDOG=1", 0.3);  // what was under way
  CHECK(systemd.hear("WATCHDOG=1", 1.0) == 0);
  kill(pid, SIGCONT);
  CHECK(systemd.hear("WATCHDOG=1", 5.0, true) == 1);
  kill(pid, SIGTERM);
  CHECK(systemd.hear("STOPPING=1", 5.0, true) == 1);
}

TEST_CASE("launch: the shipped unit is one that systemd reads, and leaves a deputy little that it could harm") {
  if (test::shell("systemd-analyze --version").code != 0) {
    MESSAGE("skipped: no systemd-analyze");
    return;
  }
  const Scratch scratch;
  std::string unit = test::read_bytes(std::string{FATHOM_SOURCE_DIR} + "/procman/fathom-deputy.service");
  CHECK(unit.find("\nUser=fathom\n") != std::string::npos);
  CHECK(unit.find("--allow ${FATHOM_ALLOW}") != std::string::npos);
  CHECK(unit.find("\nWatchdogSec=10\n") != std::string::npos);
  const std::string program = "ExecStart=fathom-deputy";
  const auto at = unit.find(program);
  REQUIRE(at != std::string::npos);
  unit.replace(at, program.size(), std::string{"ExecStart="} + FATHOM_BINARY_DIR + "/bin/deputy");
  test::write_bytes(scratch.path("fathom-deputy.service"), unit);
  const auto verified = test::shell("systemd-analyze verify " + scratch.path("fathom-deputy.service"));
  CHECK_MESSAGE(verified.code == 0, verified.text);
  // 0 is no exposure, 100 a service that may do everything.
  const auto security = test::shell("systemd-analyze security --offline=true --threshold=25 " +
                                    scratch.path("fathom-deputy.service") + "");
  CHECK_MESSAGE(security.code == 0, security.text);
}

}  // namespace fathom
