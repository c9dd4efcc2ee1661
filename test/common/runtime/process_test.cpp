// The runtime through a tiny process: it hears DEPTH and BATTERY and says STATE.
#include "common/runtime/process.hpp"

#include <doctest/doctest.h>

#include <fathom_lcm/battery_t.hpp>
#include <fathom_lcm/depth_t.hpp>
#include <fathom_lcm/state_t.hpp>
#include <iostream>
#include <limits>
#include <sstream>

#include "common/base/error.hpp"
#include "common/base/version.hpp"
#include "common/runtime/bus.hpp"
#include "common/wire/channels.hpp"
#include "common/wire/decode.hpp"
#include "common/wire/log_reader.hpp"
#include "common/wire/log_writer.hpp"
#include "common/wire/minds.hpp"
#include "common/wire/sensors.hpp"
#include "test/support/scratch.hpp"

namespace fathom {
namespace {

using runtime::Process;
using test::complaint_of;
using test::Scratch;

struct Seen {
  std::string order;  // one word per message
  int restarts{};
  int ends{};
};

// Depth in, state with that depth out; the sum of all depths follows at the end.
void echo(Process& process, Seen& seen) {
  double sum = 0.0;
  Utime newest = 0;
  process.publishes<fathom_lcm::state_t>(wire::kState);
  process.on<fathom_lcm::depth_t>(wire::kDepth, wire::kDecode, [&](const Depth& depth) {
    seen.order += "d" + std::to_string(depth.utime) + " ";
    if (depth.z < 0.0) throw std::runtime_error("flying");
    sum += depth.z;
    newest = depth.utime;
    StateEstimate state{.utime = depth.utime};
    state.p_WB.z() = depth.z;
    process.publish(wire::kState, wire::encode(state));
  });
  process.on_latest<fathom_lcm::battery_t>(wire::kBattery, wire::kDecode, [&](const Battery& battery) {
    seen.order += "b" + std::to_string(battery.utime) + " ";
  });
  process.on_restart([&] { ++seen.restarts; });
  process.on_end([&] {
    ++seen.ends;
    StateEstimate state{.utime = newest};
    state.p_WB.z() = sum;
    process.publish(wire::kState, wire::encode(state));
  });
  process.run();
}

int run(std::vector<std::string> words, const std::function<void(Process&)>& setup) {
  std::vector<const char*> argv{"echo"};
  words.insert(words.end(), {"--log-level", "off"});
  for (const std::string& word : words) argv.push_back(word.c_str());
  return runtime::main("echo", static_cast<int>(argv.size()), argv.data(), setup);
}

int run_echo(const std::vector<std::string>& words, Seen& seen) {
  return run(words, [&](Process& process) { echo(process, seen); });
}

void write_depths(const std::string& path, std::initializer_list<Depth> depths,
                  std::initializer_list<Battery> batteries = {}) {
  Recording recording;
  recording.depth = depths;
  recording.battery = batteries;
  wire::write_log(recording, path);
}

std::string in(const std::string& path) { return "file://" + path; }

// What setup would complain about, with the arguments given.
std::string complaint(const std::vector<std::string>& words, const std::function<void(Process&)>& setup) {
  std::string text;
  run(words, [&](Process& process) { text = complaint_of<std::exception>([&] { setup(process); }); });
  return text;
}

}  // namespace

TEST_CASE("process: a log in gives a log out, twice the same bytes, stamped with the messages' own time") {
  const Scratch scratch;
  write_depths(scratch.path("in.lcmlog"), {{10, 1.0}, {20, 2.0}, {30, 4.0}});
  for (const char* out : {"a.lcmlog", "b.lcmlog"}) {
    Seen seen;
    CHECK(run_echo({"--in", in(scratch.path("in.lcmlog")), "--out", in(scratch.path(out))}, seen) == 0);
    CHECK(seen.order == "d10 d20 d30 ");
    CHECK(seen.ends == 1);
    CHECK(seen.restarts == 0);
  }
  CHECK(test::read_bytes(scratch.path("a.lcmlog")) == test::read_bytes(scratch.path("b.lcmlog")));
  const auto result = wire::read_log(scratch.path("a.lcmlog")).recording;
  REQUIRE(result.state.size() == 4);
  CHECK(result.state[2].utime == 30);
  CHECK(result.state[3].p_WB.z() == 7.0);
  REQUIRE(result.process_info.size() == 1);
  CHECK(result.process_info[0].utime == 10);
  CHECK(result.process_info[0].version == version());
  CHECK(result.process_info[0].channels.find("hears DEPTH depth_t\n") != std::string::npos);
  CHECK(result.health.empty());
}

TEST_CASE("process: PROCESS_INFO tells the configuration, and never the operator's key, however it is written") {
  for (const std::string token :
       {"  token: deep-blue-4711", "  \"token\": deep-blue-4711", "  token:\n    deep-blue-4711"}) {
    CAPTURE(token);
    const Scratch scratch;
    write_depths(scratch.path("in.lcmlog"), {{10, 1.0}});
    test::write_bytes(scratch.path("operator.yaml"), "operator:\n" + token + "\n");
    test::write_bytes(scratch.path("echo.yaml"), "echo: {gain: 2}\n");
    Seen seen;
    REQUIRE(run_echo({"--config", scratch.path("operator.yaml"), "--config", scratch.path("echo.yaml"), "--in",
                      in(scratch.path("in.lcmlog")), "--out", in(scratch.path("out.lcmlog"))},
                     seen) == 0);
    const auto result = wire::read_log(scratch.path("out.lcmlog")).recording;
    REQUIRE(result.process_info.size() == 1);
    CHECK(result.process_info[0].config.find("gain: 2") != std::string::npos);
    CHECK(test::read_bytes(scratch.path("out.lcmlog")).find("deep-blue-4711") == std::string::npos);
  }
}

TEST_CASE("process: several logs are merged by time, ties in the order of the arguments") {
  const Scratch scratch;
  write_depths(scratch.path("a.lcmlog"), {{10, 1.0}, {30, 1.0}});
  write_depths(scratch.path("b.lcmlog"), {}, {{10, 12.0}, {20, 12.0}, {40, 12.0}});
  Seen seen;
  CHECK(run_echo({"--in", in(scratch.path("b.lcmlog")), "--in", in(scratch.path("a.lcmlog")), "--out",
                  in(scratch.path("out.lcmlog"))},
                 seen) == 0);
  CHECK(seen.order == "b10 d10 b20 d30 b40 ");
}

TEST_CASE("process: a jump back by more than a second is one restart, a late message is none") {
  const Scratch scratch;
  constexpr Utime kSecond = 1'000'000;
  write_depths(scratch.path("a.lcmlog"), {{10 * kSecond, 1.0}, {12 * kSecond, 1.0}}, {{11 * kSecond, 12.0}});
  std::string twice = test::read_bytes(scratch.path("a.lcmlog"));
  twice += twice;
  test::write_bytes(scratch.path("twice.lcmlog"), twice);
  Seen seen;
  CHECK(run_echo({"--in", in(scratch.path("twice.lcmlog")), "--out", in(scratch.path("out.lcmlog"))}, seen) == 0);
  CHECK(seen.restarts == 1);

  int heard = 0, restarts = 0;
  const auto listen = [&](Process& process) {
    process.listens_to<fathom_lcm::depth_t>(wire::kDepth, [&](const auto&) { ++heard; });
    process.on_restart([&] { ++restarts; });
    process.run();
  };
  CHECK(run({"--in", in(scratch.path("twice.lcmlog")), "--out", in(scratch.path("heard.lcmlog"))}, listen) == 0);
  CHECK(heard == 4);
  CHECK(restarts == 0);
}

TEST_CASE("process: what is refused for its numbers moves no clock, however early or late it is stamped") {
  const Scratch scratch;
  constexpr Utime kSecond = 1'000'000;
  for (const Utime stamp : {1 * kSecond, 1000 * kSecond}) {
    CAPTURE(stamp);
    runtime::Output log{runtime::Url::parse(in(scratch.path("all.lcmlog")), "--out")};
    const auto say = [&](Utime utime, double z) {
      fathom_lcm::depth_t message{};
      message.utime = utime;
      message.z = z;
      runtime::say(log, wire::kDepth, message);
    };
    say(10 * kSecond, 1.0);
    say(stamp, std::numeric_limits<double>::quiet_NaN());
    say(11 * kSecond, 2.0);
    log.finish();
    Seen seen;
    CHECK(run_echo({"--in", in(scratch.path("all.lcmlog")), "--out", in(scratch.path("out.lcmlog"))}, seen) == 0);
    CHECK(seen.order == "d10000000 d11000000 ");
    CHECK(seen.restarts == 0);
  }
}

TEST_CASE("process: an exception in a handler ends the process with exit code 1 and without on_end") {
  const Scratch scratch;
  write_depths(scratch.path("a.lcmlog"), {{10, 1.0}, {20, -1.0}, {30, 1.0}});
  Seen seen;
  CHECK(run_echo({"--in", in(scratch.path("a.lcmlog")), "--out", in(scratch.path("out.lcmlog"))}, seen) == 1);
  CHECK(seen.order == "d10 d20 ");
  CHECK(seen.ends == 0);
}

TEST_CASE("process: a cut-off log is served to its end, rubbish in a log is exit code 1") {
  const Scratch scratch;
  const std::string path = scratch.path("a.lcmlog");
  write_depths(path, {{10, 1.0}, {20, 1.0}});
  const std::string whole = test::read_bytes(path);
  Seen cut;
  test::write_bytes(path, whole.substr(0, whole.size() - 5));
  CHECK(run_echo({"--in", in(path), "--out", in(scratch.path("out.lcmlog"))}, cut) == 0);
  CHECK(cut.order == "d10 ");
  Seen rubbish;
  test::write_bytes(path, whole + "rubbish");
  CHECK(run_echo({"--in", in(path), "--out", in(scratch.path("out.lcmlog"))}, rubbish) == 1);
}

TEST_CASE("process: what a handler rejects or cannot be decoded does not stop it") {
  const Scratch scratch;
  const std::string path = scratch.path("a.lcmlog");
  write_depths(path, {{10, 1.0}, {20, 1.0}, {30, 1.0}});
  std::string bytes = test::read_bytes(path);
  bytes[28 + 5] ^= '\x01';                              // fingerprint of the first message
  bytes[57 + 28 + 5 + 16] = static_cast<char>('\x7F');  // the second z becomes NaN
  bytes[57 + 28 + 5 + 17] = static_cast<char>('\xFF');
  test::write_bytes(path, bytes);
  Seen seen;
  CHECK(run_echo({"--in", in(path), "--out", in(scratch.path("out.lcmlog"))}, seen) == 0);
  CHECK(seen.order == "d30 ");
}

TEST_CASE("process: --interface prints channels and types and touches no bus") {
  std::ostringstream text;
  auto* before = std::cout.rdbuf(text.rdbuf());
  Seen seen;
  CHECK(run_echo({"--interface"}, seen) == 0);
  std::cout.rdbuf(before);
  CHECK(text.str() ==
        "hears DEPTH depth_t\nhears BATTERY battery_t\nsays STATE state_t\nsays HEALTH health_t\n"
        "says PROCESS_INFO process_info_t\n");
  CHECK(seen.ends == 0);
}

TEST_CASE("process: wrong arguments are exit code 1") {
  const Scratch scratch;
  const std::string path = scratch.path("a.lcmlog");
  write_depths(path, {{10, 1.0}});
  const std::vector<std::vector<std::string>> wrong{
      {"--in", in(path)},  // and no --out
      {"--in", in(path), "--out", in(path)},
      {"--in", in(path), "--in", "udpm://239.255.76.67:7667", "--out", in(path + "2")},
      {"--in", in(scratch.path("none.lcmlog")), "--out", in(path + "2")},
      {"--in", in(path), "--out", in("/nowhere/out.lcmlog")},
      {"--in", "udpm://239.255.76.67"},
      {"--in", "http://x"},
      {"--frobnicate"}};
  for (const auto& words : wrong) {
    Seen seen;
    CAPTURE(words.back());
    CHECK(run_echo(words, seen) == 1);
    CHECK(seen.order.empty());
  }
  CHECK(wire::read_log(path).recording.depth.size() == 1);  // the input was not overwritten
}

TEST_CASE("process: configuration is the section of its name, and keys nobody reads are refused") {
  const Scratch scratch;
  const std::string pipeline = scratch.path("pipeline.yaml");
  const std::string vehicle = scratch.path("vehicle.yaml");
  const std::string log = scratch.path("a.lcmlog");
  write_depths(log, {{10, 1.0}});
  test::write_bytes(pipeline, "echo:\n  gain: 2.5 m\n  more: 1 s\nother:\n  x: 1\n");
  test::write_bytes(vehicle, "thrusters: 8\n");
  const std::vector<std::string> words{
      "--config", pipeline, vehicle, "--in", in(log), "--out", in(scratch.path("out.lcmlog"))};
  CHECK(complaint(words, [&](Process& process) {
          const Config config = process.config();
          CHECK(config.quantity("gain", "m") == 2.5);
          CHECK(process.config_path("thrusters") == vehicle);
          process.run();
        }).find("more") != std::string::npos);
  CHECK(complaint(words, [](Process& process) {
          const Config config = process.config();
          (void)config.quantity("gain", "m");
          (void)config.quantity("more", "s");
          process.run();
        }).empty());
  CHECK(complaint(words, [](Process& process) { (void)process.config_path("tags"); }).find("tags") !=
        std::string::npos);
  CHECK(complaint({"--interface"}, [](Process& process) { (void)process.config(); }).find("section echo") !=
        std::string::npos);
}

TEST_CASE("process: saying what was not declared is a programming error that does not pass silently") {
  const Scratch scratch;
  write_depths(scratch.path("a.lcmlog"), {{10, 1.0}});
  const int code =
      run({"--in", in(scratch.path("a.lcmlog")), "--out", in(scratch.path("o.lcmlog"))}, [](Process& process) {
        process.on<fathom_lcm::depth_t>(wire::kDepth, wire::kDecode, [&](const Depth& depth) {
          process.publish(wire::kState, wire::encode(depth));
        });
        process.run();
      });
  CHECK(code == 1);
}

TEST_CASE("url: a live bus gets a large receive buffer unless it states one") {
  using runtime::Url;
  CHECK(Url::parse("udpm://239.255.76.67:7667?ttl=0", "--in").text ==
        "udpm://239.255.76.67:7667?ttl=0&recv_buf_size=2097152");
  CHECK(Url::parse("udpm://239.255.76.67:7667", "--in").text == "udpm://239.255.76.67:7667?recv_buf_size=2097152");
  CHECK(Url::parse("udpm://239.255.76.67:7667?recv_buf_size=9", "--in").text ==
        "udpm://239.255.76.67:7667?recv_buf_size=9");
  CHECK(Url::parse("file://a/b.lcmlog?speed=0", "--in").path == "a/b.lcmlog");
  CHECK(Url::parse("file:///b.lcmlog?mode=w", "--out").path == "/b.lcmlog");
  CHECK_FALSE(complaint_of<InputError>([] { (void)Url::parse("file://b.lcmlog?speed=2", "--in"); }).empty());
  CHECK_FALSE(complaint_of<InputError>([] { (void)Url::parse("file://b.lcmlog?mode=a", "--out"); }).empty());
}

}  // namespace fathom
