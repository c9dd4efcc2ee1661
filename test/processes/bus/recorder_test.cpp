// The recorder where the disk is full: it says so, keeps what is whole, leaves no empty files, and goes on when there
// is room.
#include <doctest/doctest.h>

#include <algorithm>
#include <filesystem>

#include "common/base/event_log.hpp"
#include "test/support/bus.hpp"

namespace fathom {
namespace {

using test::Background;
using test::Bus;
using test::now;
using test::program;
using test::Scratch;

/// The recorder's newest word.
fathom_lcm::health_t newest(const Bus& bus) {
  for (auto each = bus.health.rbegin(); each != bus.health.rend(); ++each) {
    if (each->process == "recorder") return *each;
  }
  return {};
}

/// About 160 kB/s.
void traffic(Bus& bus, double seconds) {
  fathom_lcm::thrusters_t message{};
  message.n_pwm = 1000;
  message.pwm_us.assign(1000, 1500.0);
  for (int i = 0; i < static_cast<int>(20.0 * seconds); ++i) {
    message.utime = now();
    bus.publish("THRUSTERS", message);
    bus.listen(0.05);
  }
  bus.thrusters.clear();
}

/// The same, until the recorder's newest word is of this state and holds these words.
bool traffic_until(Bus& bus, const std::string& state, const std::string& words = "") {
  const auto said = [&] {
    const auto word = newest(bus);
    return word.state == state && word.detail.find(words) != std::string::npos;
  };
  for (int i = 0; i < 120 && !said(); ++i) traffic(bus, 0.5);
  return said();
}

/// Every log in the folder is whole and holds something; how many there are.
int whole_logs(const std::string& folder) {
  int logs = 0;
  for (const auto& entry : std::filesystem::directory_iterator{folder}) {
    if (entry.path().filename().string().find(".lcmlog") == std::string::npos) continue;
    ++logs;
    EventLog log{entry.path().string()};
    while (log.next()) {
    }
    CAPTURE(entry.path().string());
    CHECK(log.events() > 0);
    CHECK_MESSAGE(log.warning().empty(), log.warning());
  }
  return logs;
}

}  // namespace

TEST_CASE("recorder: tells the room that is left and how long it lasts") {
  const Scratch scratch;
  Bus bus;
  const Background recorder{scratch, "recorder",
                            program("recorder") + " --number --file " + scratch.path("a.lcmlog") + " --in '" + bus.url +
                                "' --out '" + bus.url + "'"};
  CHECK_MESSAGE(traffic_until(bus, "running", " free, full in "), newest(bus).detail);
  recorder.stop();
  CHECK(whole_logs(scratch.path("")) == 1);
}

TEST_CASE("recorder: files that may not grow stay whole, none is empty, and the trouble is told while it lasts") {
  const Scratch scratch;
  Bus bus;
  const Background recorder{scratch, "recorder",
                            "prlimit --fsize=200000 " + program("recorder") + " --number --file " +
                                scratch.path("a.lcmlog") + " --in '" + bus.url + "' --out '" + bus.url + "'"};
  traffic(bus, 9.0);
  const bool told = std::any_of(bus.health.begin(), bus.health.end(), [](const auto& each) {
    return each.process == "recorder" && each.state == "unhealthy" &&
           each.detail.find("is the disk full?") != std::string::npos;
  });
  CHECK(told);
  CHECK(std::none_of(bus.health.begin(), bus.health.end(), [](const auto& each) { return each.state == "fault"; }));
  CHECK(newest(bus).dropped > 0);
  recorder.stop();
  const int logs = whole_logs(scratch.path(""));
  CHECK(logs >= 2);  // tried again every three seconds
  CHECK(logs <= 4);
}

TEST_CASE("recorder: on a full disk one log stays, whole; with room again the next number follows") {
  if (test::shell("unshare -rm mount -t tmpfs -o size=1m none /mnt").code != 0) {
    MESSAGE("skipped: this machine allows no file system of its own (unshare -rm)");
    return;
  }
  const Scratch scratch;
  Bus bus;
  test::write_bytes(scratch.path("script"),
                    "cd " + scratch.path("") + "; mkdir full; mount -t tmpfs -o size=64m none full\n" +
                        "head -c 63500k /dev/zero > full/filler\n" + program("recorder") +
                        " --number --file full/a.lcmlog --in '" + bus.url + "' --out '" + bus.url + "' & r=$!\n" +
                        "while [ ! -e release ]; do sleep 0.05; done; rm full/filler\n"
                        "while [ ! -e stop ]; do sleep 0.05; done; kill -TERM $r; wait $r; echo \"code $?\"\n"
                        "mkdir logs; cp full/* logs; touch copied\n");
  const Background inside{scratch, "inside", "unshare -rm bash " + scratch.path("script")};
  CHECK_MESSAGE(traffic_until(bus, "unhealthy", "the disk is nearly full: "), newest(bus).detail);  // before it is full
  CHECK_MESSAGE(traffic_until(bus, "unhealthy", "is the disk full?"), newest(bus).detail);  // 1.9 MB at 160 kB/s
  test::write_bytes(scratch.path("release"), "");
  CHECK_MESSAGE(traffic_until(bus, "running"), newest(bus).detail);
  test::write_bytes(scratch.path("stop"), "");
  for (int i = 0; i < 100 && !std::filesystem::exists(scratch.path("copied")); ++i) bus.listen(0.05);
  CHECK_MESSAGE(test::read_bytes(scratch.path("inside.text")).find("code 0") != std::string::npos,
                test::read_bytes(scratch.path("inside.text")));
  CHECK(whole_logs(scratch.path("logs")) == 2);
}

}  // namespace fathom
