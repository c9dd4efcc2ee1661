// What is recorded stays whole when the disk is full; how long a disk lasts; names without a fixed limit.
#include "common/runtime/record_file.hpp"

#include <doctest/doctest.h>
#include <sys/resource.h>

#include <csignal>
#include <filesystem>

#include "common/base/error.hpp"
#include "common/base/event_log.hpp"
#include "common/runtime/disk_room.hpp"
#include "test/support/scratch.hpp"

using namespace fathom;
using runtime::DiskRoom;
using runtime::RecordFile;

namespace {

/// No file may grow beyond so many bytes meanwhile.
class FileLimit {
 public:
  explicit FileLimit(rlim_t bytes) {
    getrlimit(RLIMIT_FSIZE, &before_);
    rlimit now = before_;
    now.rlim_cur = bytes;
    setrlimit(RLIMIT_FSIZE, &now);
    handler_ = std::signal(SIGXFSZ, SIG_IGN);
  }
  ~FileLimit() {
    setrlimit(RLIMIT_FSIZE, &before_);
    std::signal(SIGXFSZ, handler_);
  }
  FileLimit(const FileLimit&) = delete;
  FileLimit& operator=(const FileLimit&) = delete;

 private:
  rlimit before_{};
  void (*handler_)(int){};
};

std::uint64_t events_of(const std::string& path) {
  EventLog log{path};
  while (log.next()) {
  }
  CHECK_MESSAGE(log.warning().empty(), log.warning());
  return log.events();
}

/// Writes events of 100 bytes until it fails; how many were taken.
std::uint64_t fill(RecordFile& file) {
  std::vector<std::uint8_t> bytes(100, 7);
  for (std::uint64_t i = 0; i < 10'000; ++i) {
    try {
      file.write("DEPTH", bytes, 1'700'000'000'000'000 + static_cast<Utime>(i));
      if (i % 7 == 6) file.keep();
    } catch (const InputError& error) {
      CHECK(std::string{error.what()}.find("is the disk full?") != std::string::npos);
      return i;
    }
  }
  FAIL("the limit does not bind");
  return 0;
}

}  // namespace

TEST_CASE("record file: of a full disk every whole event stays, and nothing that is cut off") {
  const test::Scratch scratch;
  const std::string path = scratch.path("a.lcmlog");
  constexpr std::uint64_t kEvent = 28 + 5 + 100;
  for (const rlim_t limit : {rlim_t{20'000}, rlim_t{133 * 50}, rlim_t{133 * 50 + 1}, rlim_t{133 * 50 - 1}}) {
    CAPTURE(limit);
    {
      const FileLimit full{limit};
      RecordFile file{path};
      (void)fill(file);
    }
    CHECK(events_of(path) == limit / kEvent);
    CHECK(std::filesystem::file_size(path) == limit / kEvent * kEvent);
  }
}

TEST_CASE("record file: one that holds no event is removed, one that does is not") {
  const test::Scratch scratch;
  const std::string path = scratch.path("a.lcmlog");
  {
    const FileLimit full{60};
    RecordFile file{path};
    (void)fill(file);
  }
  CHECK_FALSE(std::filesystem::exists(path));
  { const RecordFile file{path}; }
  CHECK_FALSE(std::filesystem::exists(path));
  {
    RecordFile file{path};
    std::vector<std::uint8_t> bytes(8, 7);
    file.write("DEPTH", bytes, 1'700'000'000'000'000);
  }
  CHECK(events_of(path) == 1);
}

TEST_CASE("numbered logs: the next number, whatever is missing between, and no limit") {
  const test::Scratch scratch;
  const std::string path = scratch.path("trial.lcmlog");
  CHECK(runtime::next_numbered(path) == path + ".00");
  for (const char* end : {".00", ".02", ".xy", ".", "x.77"}) test::write_bytes(path + end, "");
  CHECK(runtime::next_numbered(path) == path + ".03");
  test::write_bytes(path + ".999", "");
  CHECK(runtime::next_numbered(path) == path + ".1000");
  test::write_bytes(path + ".54321", "");
  CHECK(runtime::next_numbered(path) == path + ".54322");
}

TEST_CASE("disk room: time left at the present rate, told before it is too short") {
  DiskRoom room{{.least_time = 120.0, .least_free = 32'000'000}};
  CHECK(room.trouble().empty());  // nothing is known yet
  room.measure(0, 10'000'000'000, 0.0);
  CHECK(room.text() == "10.0 GB free");
  for (int i = 1; i <= 60; ++i) room.measure(static_cast<std::uint64_t>(i) * 500'000, 10'000'000'000, i);
  CHECK(room.rate() == doctest::Approx(500'000.0));
  REQUIRE(room.time_left());
  CHECK(*room.time_left() == doctest::Approx(20'000.0));
  CHECK(room.text() == "10.0 GB free, full in 6 h at 0.5 MB/s");
  CHECK(room.trouble().empty());
  room.measure(61 * 500'000, 50'000'000, 61.0);  // 100 s
  CHECK(room.trouble() ==
        "the disk is nearly full: 50.0 MB free, full in 100 s at 0.5 MB/s, where 32.0 MB and 2 min are wanted; make "
        "room");
  DiskRoom idle;
  idle.measure(0, 20'000'000, 0.0);
  idle.measure(0, 20'000'000, 1.0);
  CHECK_FALSE(idle.time_left());
  CHECK(idle.trouble().find("20.0 MB free, where 32.0 MB") != std::string::npos);
  idle.measure(0, 20'000'000'000, 2.0);
  CHECK(idle.trouble().empty());
}
