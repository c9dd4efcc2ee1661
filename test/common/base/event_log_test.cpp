// Logs byte by byte: what is whole is read, what was cut off is said, what is damaged is refused with its place.
#include "common/base/event_log.hpp"

#include <doctest/doctest.h>

#include <filesystem>

#include "common/base/error.hpp"
#include "test/support/scratch.hpp"

namespace fathom {
namespace {

using test::complaint_of;

void put(std::string& bytes, std::uint64_t value, int count) {  // big-endian
  for (int i = count - 1; i >= 0; --i) bytes += static_cast<char>(value >> (8 * i));
}

/// One event as lcm-logger writes it; lengths may lie.
std::string event(std::uint64_t number, Utime time, const std::string& channel, const std::string& data,
                  std::uint32_t said_channel = 0, std::uint32_t said_data = 0) {
  std::string bytes;
  put(bytes, 0xEDA1DA01, 4);
  put(bytes, number, 8);
  put(bytes, static_cast<std::uint64_t>(time), 8);
  put(bytes, said_channel != 0 ? said_channel : channel.size(), 4);
  put(bytes, said_data != 0 ? said_data : data.size(), 4);
  return bytes + channel + data;
}

std::string text_of(const LogEvent& event) { return {event.data.begin(), event.data.end()}; }

struct Log {
  test::Scratch scratch;
  std::string path = scratch.path("a.lcmlog");
  explicit Log(const std::string& bytes) { test::write_bytes(path, bytes); }
  [[nodiscard]] std::string opening() const {
    return complaint_of<InputError>([&] { EventLog{path}; });
  }
  /// The complaint of reading to the end.
  [[nodiscard]] std::string reading() const {
    return complaint_of<InputError>([&] {
      EventLog log{path};
      while (log.next()) {
      }
    });
  }
};

bool contains(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

const std::string kFirst = event(0, 1'700'000'000'000'000, "DEPTH", "abc");
const std::string kSecond = event(1, -5, "IMU", "");

}  // namespace

TEST_CASE("event log: time, channel, data and place of every event") {
  const Log file{kFirst + kSecond + event(2, 7, std::string(63, 'C'), std::string(100'000, 'x'))};
  EventLog log{file.path};
  CHECK(log.path() == file.path);
  auto one = log.next();
  REQUIRE(one);
  CHECK(one->time == 1'700'000'000'000'000);
  CHECK(one->channel == "DEPTH");
  CHECK(text_of(*one) == "abc");
  CHECK(one->offset == 0);
  one = log.next();
  REQUIRE(one);
  CHECK(one->time == -5);
  CHECK(one->channel == "IMU");
  CHECK(one->data.empty());
  CHECK(one->offset == kFirst.size());
  one = log.next();
  REQUIRE(one);
  CHECK(one->channel.size() == 63);
  CHECK(one->data.size() == 100'000);
  CHECK_FALSE(log.next());
  CHECK_FALSE(log.next());
  CHECK(log.events() == 3);
  CHECK(log.warning().empty());
}

TEST_CASE("event log: an event that was cut off anywhere ends the log with a warning") {
  for (std::size_t left = 1; left < kFirst.size(); ++left) {
    const Log file{kSecond + kFirst.substr(0, left)};
    EventLog log{file.path};
    CHECK(log.next());
    CHECK_FALSE(log.next());
    CHECK_FALSE(log.next());
    CAPTURE(left);
    CHECK(log.warning() == file.path + ": byte " + std::to_string(kSecond.size()) +
                               " (after 1 events): the last event is cut off; 1 events recovered");
  }
}

TEST_CASE("event log: a length that reaches past the end is a lie when whole events follow") {
  const std::string lying = event(1, 5, "DEPTH", "abc", 0, 5000);
  const Log file{kFirst + lying + kFirst};
  CHECK(
      contains(file.reading(), "byte " + std::to_string(kFirst.size()) +
                                   " (after 1 events): length reaches past the end of the file; keep what is before"));
  // Alone at the end it cannot be told from an event that was cut off.
  const Log last{kFirst + lying};
  CHECK(last.reading().empty());
  // A sync word inside the data does not make an event.
  const Log sync{kFirst +
                 event(1, 5, "DEPTH", kSecond.substr(0, 4) + "rubbish behind it that is no header at all", 0, 5000)};
  CHECK(sync.reading().empty());
}

TEST_CASE("event log: rubbish and absurd lengths are refused with place and remedy") {
  const Log rubbish{kFirst + "what is this?" + kFirst};
  CHECK(
      contains(rubbish.reading(), ": byte " + std::to_string(kFirst.size()) +
                                      " (after 1 events): rubbish where an event should begin; keep what is before and "
                                      "behind it with: fathom repair-log LOG --out REPAIRED"));
  for (const std::string& absurd : {event(1, 5, "DEPTH", "abc", 64), event(1, 5, "DEPTH", "abc", 0xFFFFFFFF),
                                    event(1, 5, "DEPTH", "abc", 0, 0x10000001), event(1, 5, "", "abc")}) {
    CHECK(contains(Log{kFirst + absurd}.reading(), "absurd length"));
  }
}

TEST_CASE("event log: what is no log is refused when it is opened") {
  CHECK(contains(Log{""}.opening(), "empty file"));
  CHECK(contains(Log{"\xED\xA1"}.opening(), "not an LCM log"));
  CHECK(contains(Log{"t,x,y,z\n"}.opening(), "not an LCM log"));
  const test::Scratch scratch;
  CHECK(contains(complaint_of<InputError>([&] { EventLog{scratch.path("")}; }), "is a folder"));
  CHECK(contains(complaint_of<InputError>([&] { EventLog{scratch.path("none.lcmlog")}; }), "cannot be read"));
}

}  // namespace fathom
