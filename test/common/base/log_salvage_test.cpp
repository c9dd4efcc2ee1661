// Damaged logs: what is whole before and behind the damage is kept byte for byte, the damage is counted with its place.
#include "common/base/log_salvage.hpp"

#include <doctest/doctest.h>

#include <filesystem>
#include <random>

#include "common/base/error.hpp"
#include "common/base/event_log.hpp"
#include "test/support/scratch.hpp"

namespace fathom {
namespace {

void put(std::string& bytes, std::uint64_t value, int count) {  // big-endian
  for (int i = count - 1; i >= 0; --i) bytes += static_cast<char>(value >> (8 * i));
}

std::string event(std::uint64_t number, const std::string& channel, const std::string& data, std::uint32_t said = 0) {
  std::string bytes;
  put(bytes, 0xEDA1DA01, 4);
  put(bytes, number, 8);
  put(bytes, 1'700'000'000'000'000 + number, 8);
  put(bytes, channel.size(), 4);
  put(bytes, said != 0 ? said : data.size(), 4);
  return bytes + channel + data;
}

struct Kept {
  std::string bytes;
  Salvage result;
  explicit Kept(const std::string& log) {
    result = salvage({reinterpret_cast<const std::uint8_t*>(log.data()), log.size()}, [&](auto event, std::size_t) {
      bytes.append(reinterpret_cast<const char*>(event.data()), event.size());
    });
  }
};

const std::string kA = event(0, "DEPTH", "abc"), kB = event(1, "AHRS", std::string(300, 'x')),
                  kC = event(2, "DEPTH", "");
const std::string kSync{"\xED\xA1\xDA\x01", 4};

}  // namespace

TEST_CASE("salvage: a whole log is kept as it is") {
  const Kept kept{kA + kB + kC};
  CHECK(kept.bytes == kA + kB + kC);
  CHECK(kept.result.events == 3);
  CHECK(kept.result.channels.at("DEPTH") == 2);
  CHECK(kept.result.damages.empty());
}

TEST_CASE("salvage: rubbish between, before and behind events is left out and nothing else") {
  const Kept kept{"rubbish" + kA + "more" + kB + kC + "end"};
  CHECK(kept.bytes == kA + kB + kC);
  REQUIRE(kept.result.damages.size() == 3);
  CHECK(kept.result.damages[1].offset == 7 + kA.size());
  CHECK(kept.result.damages[1].bytes == 4);
  CHECK(kept.result.damages[1].events_before == 1);
  CHECK(kept.result.lost() == 14);
}

TEST_CASE("salvage: an event with a false length does not take others along, be it too long or too short") {
  CHECK(Kept{kA + event(5, "DVL", "abc", 200) + kB + kC}.bytes == kA + kB + kC);
  CHECK(Kept{kA + event(5, "DVL", "abc", 0xFFFFFFFF) + kB + kC}.bytes == kA + kB + kC);
  CHECK(Kept{kA + event(5, "DVL", "abc", 100'000) + kB + kC}.bytes == kA + kB + kC);
  const std::string shortened = event(5, "DVL", "abcdef", 2);  // kept with what it says: its data will not decode
  CHECK(Kept{kA + shortened + kB + kC}.bytes.ends_with(kB + kC));
}

TEST_CASE("salvage: a cut-off last event and a headless first one are lost alone") {
  CHECK(Kept{kA + kB.substr(0, kB.size() - 1)}.bytes == kA);
  CHECK(Kept{kA.substr(2) + kB + kC}.bytes == kB + kC);
  CHECK(Kept{kA + kSync}.bytes == kA);
}

TEST_CASE("salvage: a sync word, or a whole event, inside an event's data changes nothing") {
  CHECK(Kept{kA + event(1, "X", "data" + kSync + "data") + kC}.bytes ==
        kA + event(1, "X", "data" + kSync + "data") + kC);
  CHECK(Kept{kA + event(1, "X", kA + kB) + kC}.bytes == kA + event(1, "X", kA + kB) + kC);
}

TEST_CASE("salvage: a channel that holds no letters is no event") {
  CHECK(Kept{kA + event(1, std::string("\x01\x02", 2), "abc") + kC}.bytes == kA + kC);
}

TEST_CASE("salvage: whatever stretch of a log is overwritten, only the events it touches are lost") {
  std::mt19937 random{11};
  std::vector<std::string> events;
  std::string log;
  for (std::uint64_t i = 0; i < 60; ++i) {
    std::string data(random() % 400, ' ');
    for (char& c : data) c = static_cast<char>(random());
    events.push_back(event(i, i % 3 == 0 ? "AHRS" : "STATE", data));
    log += events.back();
  }
  for (int trial = 0; trial < 300; ++trial) {
    std::string damaged = log;
    const std::size_t from = random() % log.size(), count = 1 + random() % 500, to = std::min(log.size(), from + count);
    for (std::size_t i = from; i < to; ++i) damaged[i] = static_cast<char>(random());
    const Kept kept{damaged};
    std::size_t at = 0, untouched = 0, found = 0;
    for (const std::string& each : events) {
      const bool touched = at < to && at + each.size() > from;
      at += each.size();
      if (touched) continue;
      ++untouched;
      found += kept.bytes.find(each) != std::string::npos ? 1 : 0;
    }
    CHECK(found == untouched);
  }
}

TEST_CASE("salvage: whatever time an event claims, another recording begins only where time goes back") {
  const auto at = [](std::uint64_t time) {
    std::string bytes;
    put(bytes, time, 8);
    return event(7, "DEPTH", "abc").replace(12, 8, bytes);
  };
  constexpr std::uint64_t kFirst = std::uint64_t{1} << 63U, kLast = kFirst - 1;  // of all that 64 bits can say
  CHECK(Kept{at(kFirst + 512) + at(kFirst + 1024)}.result.parts.size() == 1);
  CHECK(Kept{at(kFirst) + at(kLast)}.result.parts.size() == 1);
  CHECK(Kept{at(kLast) + at(kFirst)}.result.parts.size() == 2);
  CHECK(Kept{at(1'700'000'000'000'000) + at(1'699'999'999'100'000)}.result.parts.size() == 1);  // a clock that was set
  CHECK(Kept{at(1'700'000'000'000'000) + at(1'699'999'998'900'000)}.result.parts.size() == 2);
}

TEST_CASE("salvage: from file to file; nothing is overwritten and nothing empty is left") {
  const test::Scratch scratch;
  test::write_bytes(scratch.path("a"), kA + "xx" + kB);
  const Salvage result = salvage(scratch.path("a"), scratch.path("b"));
  CHECK(result.events == 2);
  CHECK(test::read_bytes(scratch.path("b")) == kA + kB);
  EventLog repaired{scratch.path("b")};
  CHECK(repaired.next().has_value());
  CHECK(repaired.next().has_value());
  CHECK_FALSE(repaired.next().has_value());
  const auto refusal = [&](const char* from, const char* to) {
    return test::complaint_of<InputError>([&] { (void)salvage(scratch.path(from), scratch.path(to)); });
  };
  CHECK(refusal("a", "b").ends_with("b: exists already; name another file"));
  CHECK(refusal("none", "c").find("none: cannot be read") != std::string::npos);
  CHECK(refusal("a", "no/folder").find("cannot be written") != std::string::npos);
  test::write_bytes(scratch.path("rubbish"), std::string(5000, 'x'));
  CHECK(refusal("rubbish", "c").ends_with("holds no whole event of an LCM log"));
  test::write_bytes(scratch.path("empty"), "");
  CHECK(refusal("empty", "c").ends_with("holds no whole event of an LCM log"));
  CHECK(test::read_bytes(scratch.path("c")).empty());
}

TEST_CASE("salvage: recordings that were joined go to files of their own, for a logger's count begins again") {
  const test::Scratch scratch;
  test::write_bytes(scratch.path("joined"), kA + kB + kC + kA + kB + kA);
  const Salvage result = salvage(scratch.path("joined"), scratch.path("part.lcmlog"));
  REQUIRE(result.parts.size() == 3);
  CHECK(result.events == 6);
  CHECK(result.parts[1].begin == (kA + kB + kC).size());
  CHECK(result.parts[1].events_before == 3);
  CHECK(test::read_bytes(scratch.path("part-1.lcmlog")) == kA + kB + kC);
  CHECK(test::read_bytes(scratch.path("part-2.lcmlog")) == kA + kB);
  CHECK(test::read_bytes(scratch.path("part-3.lcmlog")) == kA);
  CHECK(test::read_bytes(scratch.path("part.lcmlog")).empty());
  // Where a later part has no place, nothing of the others stays.
  const std::string refused =
      test::complaint_of<InputError>([&] { (void)salvage(scratch.path("joined"), scratch.path("part.lcmlog")); });
  CHECK(refused.ends_with("part-1.lcmlog: exists already; name another file"));
  CHECK_FALSE(std::filesystem::exists(scratch.path("part.lcmlog")));
  CHECK(test::read_bytes(scratch.path("part-1.lcmlog")) == kA + kB + kC);
  // Events that are missing are damage, and no other recording.
  CHECK(Kept{kA + kC}.result.parts.size() == 1);
  EventLog log{scratch.path("joined")};
  int begins = 0;
  while (const auto each = log.next()) begins += each->begins_anew ? 1 : 0;
  CHECK(begins == 2);
}

}  // namespace fathom
