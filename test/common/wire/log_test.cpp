// Logs: what is written comes back, the same recording gives the same bytes, and damage is named with its place.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <fathom_lcm/camera_t.hpp>
#include <fathom_lcm/depth_t.hpp>
#include <filesystem>
#include <lcm/lcm-cpp.hpp>

#include "common/base/error.hpp"
#include "common/wire/log_parts.hpp"
#include "common/wire/log_writer.hpp"
#include "common/wire/sensors.hpp"
#include "common/wire/streams.hpp"
#include "test/support/filled_samples.hpp"
#include "test/support/scratch.hpp"

namespace fathom {
namespace {

using test::complaint_of;

// Three samples of every stream, a millisecond apart.
Recording everything() {
  Recording recording;
  test::Fill fill;
  Utime utime = 1'000'000;
  for (int i = 0; i < 3; ++i) {
    wire::visit_streams(recording, [&](const char*, auto& samples) {
      auto& sample = samples.emplace_back();
      test::fill(fill, sample);
      sample.utime = utime += 1000;
    });
  }
  return recording;
}

Recording depths(std::initializer_list<Utime> utimes) {
  Recording recording;
  for (const Utime utime : utimes) recording.depth.push_back({.utime = utime, .z = 1.5});
  return recording;
}

void write_raw(const std::string& path, const std::string& channel, std::vector<std::uint8_t> data) {
  lcm::LogFile log{path, "a"};
  lcm::LogEvent event{};
  event.channel = channel;
  event.datalen = static_cast<int>(data.size());
  event.data = data.data();
  REQUIRE(log.writeEvent(&event) == 0);
}

std::vector<std::uint8_t> depth_bytes(double z) {
  fathom_lcm::depth_t message{};
  message.z = z;
  std::vector<std::uint8_t> bytes(static_cast<std::size_t>(message.getEncodedSize()));
  message.encode(bytes.data(), 0, static_cast<int>(bytes.size()));
  return bytes;
}

bool contains(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

constexpr std::size_t kDepthEvent = 28 + 5 + 24;  // header, "DEPTH", fingerprint with utime and z

}  // namespace

TEST_CASE("log: every stream comes back, and writing it again gives the same bytes") {
  const test::Scratch scratch;
  const Recording recording = everything();
  CHECK(wire::write_log(recording, scratch.path("a.lcmlog")) == 3 * 26);
  const auto contents = wire::read_log(scratch.path("a.lcmlog"));
  CHECK(contents.recording.name == "a");
  CHECK(contents.report.events == 3 * 26);
  CHECK(contents.report.warning.empty());
  CHECK(wire::complaints("a", contents.report).empty());
  CHECK(contents.recording.truth.size() == 3);
  CHECK(contents.recording.model.at(2).parameters.at(1).name == recording.model.at(2).parameters.at(1).name);
  wire::write_log(contents.recording, scratch.path("b.lcmlog"));
  CHECK(test::read_bytes(scratch.path("a.lcmlog")) == test::read_bytes(scratch.path("b.lcmlog")));
}

TEST_CASE("log: events are in the order of time over all channels, stamped with their utime, readable by liblcm") {
  const test::Scratch scratch;
  Recording recording = depths({10, 30});
  recording.battery = {{.utime = 20, .voltage = 12.0}, {.utime = 30, .voltage = 12.0}};
  wire::write_log(recording, scratch.path("a.lcmlog"));
  lcm::LogFile log{scratch.path("a.lcmlog"), "r"};
  std::string order;
  while (const auto* event = log.readNextEvent()) order += std::to_string(event->timestamp) + event->channel + " ";
  CHECK(order == "10DEPTH 20BATTERY 30BATTERY 30DEPTH ");
}

TEST_CASE("log: a few pictures of many, evenly from the first to the last") {
  const test::Scratch scratch;
  {
    lcm::LogFile log{scratch.path("a.lcmlog"), "w"};
    for (int i = 0; i < 30; ++i) {
      const auto message = wire::encode(Camera{.utime = i, .camera = "down", .width = 2, .height = 1, .jpeg = {0xff}});
      std::vector<std::uint8_t> bytes(static_cast<std::size_t>(message.getEncodedSize()));
      message.encode(bytes.data(), 0, static_cast<int>(bytes.size()));
      lcm::LogEvent event{};
      event.timestamp = i;
      event.channel = i % 3 == 2 ? "CAMERA" : "CAMERA_DEBUG";
      event.datalen = static_cast<int>(bytes.size());
      event.data = bytes.data();
      REQUIRE(log.writeEvent(&event) == 0);
    }
  }
  const auto times = [&](const std::string& channel, std::size_t most) {
    std::vector<Utime> found;
    for (const Camera& each : wire::read_pictures(scratch.path("a.lcmlog"), channel, most)) found.push_back(each.utime);
    return found;
  };
  CHECK(times("CAMERA_DEBUG", 3) == std::vector<Utime>{0, 13, 28});
  CHECK(times("CAMERA_DEBUG", 1) == std::vector<Utime>{0});
  CHECK(times("CAMERA_DEBUG", 0).empty());
  CHECK(times("CAMERA", 99).size() == 10);
  CHECK(times("DEPTH", 3).empty());
}

TEST_CASE("log: a sample that a reader would refuse is refused by the writer, with its channel and number") {
  const test::Scratch scratch;
  Recording recording = depths({10, 30});
  recording.depth[1].z = std::nan("");
  const auto text = complaint_of<InputError>([&] { wire::write_log(recording, scratch.path("a.lcmlog")); });
  CHECK(contains(text, "DEPTH: sample 1"));
  CHECK_FALSE(std::filesystem::exists(scratch.path("a.lcmlog")));
}

TEST_CASE("log: parts that follow one another give the bytes of the whole; what is not finished replaces nothing") {
  const test::Scratch scratch;
  const std::string path = scratch.path("a.lcmlog");
  Recording whole = depths({10, 20, 30, 40}), first = depths({10, 20}), second = depths({30, 40});
  whole.battery = {{.utime = 20, .voltage = 12.0}, {.utime = 40, .voltage = 11.0}};
  first.battery = {whole.battery[0]};
  second.battery = {whole.battery[1]};
  wire::write_log(whole, scratch.path("whole.lcmlog"));
  {
    wire::LogWriter log{path};
    log.append(first);
    log.append(second);
    CHECK_FALSE(std::filesystem::exists(path));
    CHECK(log.finish() == 6);
    CHECK(log.counts() == "BATTERY 2, DEPTH 4");
  }
  const std::string bytes = test::read_bytes(path);
  CHECK(bytes == test::read_bytes(scratch.path("whole.lcmlog")));
  {
    wire::LogWriter log{path};
    log.append(depths({50}));
    Recording bad = depths({60});
    bad.depth[0].z = std::nan("");
    CHECK_THROWS_AS(log.append(bad), InputError);
  }
  CHECK(test::read_bytes(path) == bytes);
  CHECK_FALSE(std::filesystem::exists(path + ".part"));
}

TEST_CASE("log: parts that are read one after the other hold together what the whole holds, and count the same") {
  const test::Scratch scratch;
  const std::string path = scratch.path("run.lcmlog");
  Recording recording = everything();
  for (int i = 0; i < 200; ++i) recording.depth.push_back({.utime = 2'000'000 + 1000 * i, .z = 0.1 * i});
  wire::write_log(recording, path);
  const wire::LogContents whole = wire::read_log(path);
  wire::LogParts parts{path};
  std::vector<std::size_t> sizes;
  Recording together;
  for (Recording part; parts.next(10 * sizeof(Depth), part); part = {}) {
    CHECK(part.name == "run");
    CHECK(wire::bytes_of(part) < 10 * sizeof(Depth) + sizeof(StateEstimate) + sizeof(SmoothedState));
    sizes.push_back(wire::bytes_of(part));
    wire::visit_streams(part, [&](const char* channel, const auto& stream) {
      wire::visit_streams(together, [&](const char* other, auto& all) {
        if constexpr (std::is_same_v<std::decay_t<decltype(stream)>, std::decay_t<decltype(all)>>) {
          CHECK(std::string{channel} == other);
          all.insert(all.end(), stream.begin(), stream.end());
        }
      });
    });
  }
  CHECK(sizes.size() > 20);
  const std::string again = scratch.path("again.lcmlog"), once = scratch.path("once.lcmlog");
  wire::write_log(together, again);
  wire::write_log(whole.recording, once);
  CHECK(test::read_bytes(again) == test::read_bytes(once));
  for (const auto& [channel, count] : whole.report.channels)
    CHECK(parts.report().channels.at(channel).accepted == count.accepted);
  CHECK(parts.report().events == whole.report.events);
}

TEST_CASE("log: a stream that is out of order is put into the order of time") {
  const test::Scratch scratch;
  Recording mixed = depths({30, 10, 20});
  mixed.battery = {{.utime = 15, .voltage = 12.0}};
  wire::write_log(mixed, scratch.path("a.lcmlog"));
  lcm::LogFile log{scratch.path("a.lcmlog"), "r"};
  std::string order;
  while (const auto* event = log.readNextEvent()) order += std::to_string(event->timestamp) + " ";
  CHECK(order == "10 15 20 30 ");
}

TEST_CASE("log: a cut-off last event is a warning with the number of events recovered") {
  const test::Scratch scratch;
  const std::string path = scratch.path("a.lcmlog");
  wire::write_log(depths({10, 20, 30}), path);
  const std::string whole = test::read_bytes(path);
  REQUIRE(whole.size() == 3 * kDepthEvent);
  for (std::size_t cut = 2 * kDepthEvent + 1; cut < whole.size(); ++cut) {
    test::write_bytes(path, whole.substr(0, cut));
    const auto contents = wire::read_log(path);
    CAPTURE(cut);
    CHECK(contents.recording.depth.size() == 2);
    CHECK(
        contains(contents.report.warning, "byte 114 (after 2 events): the last event is cut off; 2 events recovered"));
  }
}

TEST_CASE("log: rubbish between events is an error that names file, byte and remedy") {
  const test::Scratch scratch;
  const std::string path = scratch.path("a.lcmlog");
  wire::write_log(depths({10, 20, 30}), path);
  std::string bytes = test::read_bytes(path);
  bytes.insert(kDepthEvent, "xyz");
  test::write_bytes(path, bytes);
  const auto text = complaint_of<InputError>([&] { (void)wire::read_log(path); });
  CHECK(contains(text, path + ": byte 57 (after 1 events): rubbish where an event should begin; keep what is before "
                              "and behind it with: fathom repair-log LOG --out REPAIRED"));
}

TEST_CASE("log: absurd lengths, and a length that would swallow later events, are errors and not a cut-off end") {
  const test::Scratch scratch;
  const std::string path = scratch.path("a.lcmlog");
  wire::write_log(depths({10, 20, 30}), path);
  const std::string whole = test::read_bytes(path);
  std::string huge = whole;
  huge[kDepthEvent + 24] = '\x7F';  // first byte of the second event's data length
  test::write_bytes(path, huge);
  CHECK(contains(complaint_of<InputError>([&] { (void)wire::read_log(path); }),
                 "byte 57 (after 1 events): absurd length"));
  std::string negative = whole;
  negative[kDepthEvent + 20] = '\xFF';  // of its channel length
  test::write_bytes(path, negative);
  CHECK(contains(complaint_of<InputError>([&] { (void)wire::read_log(path); }), "absurd length"));
  std::string longer = whole;
  longer[kDepthEvent + 26] = '\x01';  // 256 bytes more than there are
  test::write_bytes(path, longer);
  CHECK(contains(complaint_of<InputError>([&] { (void)wire::read_log(path); }), "length reaches past the end"));
}

TEST_CASE("log: files that are no log are refused with what they are") {
  const test::Scratch scratch;
  const std::string path = scratch.path("a.lcmlog");
  const auto complaint = [&] { return complaint_of<InputError>([&] { (void)wire::read_log(path); }); };
  CHECK(contains(complaint(), "cannot be read"));
  test::write_bytes(path, "");
  CHECK(contains(complaint(), "empty file"));
  test::write_bytes(path, "t,x,y\n0,1,2\n");
  CHECK(contains(complaint(), "not an LCM log"));
  test::write_bytes(path, "\xED\xA1");
  CHECK(contains(complaint(), "not an LCM log"));
  std::filesystem::remove(path);
  write_raw(path, "SOMETHING_ELSE", depth_bytes(1.0));
  CHECK(contains(complaint(), "none of its 1 events is on a channel that Fathom knows"));
}

TEST_CASE("log: bad messages are counted per channel, the good ones around them are kept") {
  const test::Scratch scratch;
  const std::string path = scratch.path("a.lcmlog");
  auto trailing = depth_bytes(1.0);
  trailing.push_back(0);
  write_raw(path, "DEPTH", depth_bytes(1.0));
  write_raw(path, "DEPTH", depth_bytes(std::nan("")));
  write_raw(path, "DEPTH", trailing);
  write_raw(path, "DEPTH", {});
  write_raw(path, "DEPTH", depth_bytes(2.0));
  write_raw(path, "FOREIGN", {1, 2, 3});
  const auto contents = wire::read_log(path);
  REQUIRE(contents.recording.depth.size() == 2);
  CHECK(contents.recording.depth[1].z == 2.0);
  const auto& count = contents.report.channels.at("DEPTH");
  CHECK(count.accepted == 2);
  CHECK(count.rejected == 3);
  CHECK(count.first_rejected == kDepthEvent);
  CHECK(contents.report.foreign == 1);
  CHECK(contains(wire::complaints(path, contents.report), "channel DEPTH: 3 of 5 messages refused"));
}

TEST_CASE("log: another version of a message type is named, not skipped") {
  const test::Scratch scratch;
  auto bytes = depth_bytes(1.0);
  bytes[0] = static_cast<std::uint8_t>(bytes[0] ^ 1U);
  write_raw(scratch.path("a.lcmlog"), "DEPTH", bytes);
  const auto text = complaint_of<InputError>([&] { (void)wire::read_log(scratch.path("a.lcmlog")); });
  CHECK(contains(text, "channel DEPTH does not hold this version's depth_t"));
}

TEST_CASE("log: of another version, what says nothing of the motion is left out and counted, and the rest is read") {
  const test::Scratch scratch;
  const std::string path = scratch.path("a.lcmlog");
  write_raw(path, "DEPTH", depth_bytes(1.0));
  for (const char* channel : {"ANSWER", "HEALTH", "OPERATOR", "PROCESS_INFO", "WRENCH_COMMAND"}) {
    write_raw(path, channel, depth_bytes(1.0));  // a fingerprint that is not theirs
  }
  const auto contents = wire::read_log(path);
  CHECK(contents.recording.depth.size() == 1);
  CHECK(contents.recording.health.empty());
  const auto& count = contents.report.channels.at("HEALTH");
  CHECK(count.other_version == 1);
  CHECK(count.rejected == 0);
  const std::string said = wire::complaints(path, contents.report);
  CHECK(contains(said, "channel HEALTH: 1 messages of another version of Fathom left out"));
  CHECK(std::ranges::count(said, '\n') == 5);
}

TEST_CASE("log: messages that were logged late are sorted into place and counted") {
  const test::Scratch scratch;
  const std::string path = scratch.path("a.lcmlog");
  for (const Utime utime : {20, 10}) {
    fathom_lcm::depth_t message{};
    message.utime = utime;
    std::vector<std::uint8_t> bytes(static_cast<std::size_t>(message.getEncodedSize()));
    message.encode(bytes.data(), 0, static_cast<int>(bytes.size()));
    write_raw(path, "DEPTH", bytes);
  }
  const auto contents = wire::read_log(path);
  CHECK(contents.recording.depth.at(0).utime == 10);
  CHECK(contents.report.channels.at("DEPTH").late == 1);
}

}  // namespace fathom
