// procman's messages: the fingerprints that its own programs have, and nothing lost on the way.
#include "common/wire/launch.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <limits>
#include <procman_lcm/deputy_info_t.hpp>
#include <procman_lcm/discovery_t.hpp>
#include <procman_lcm/orders_t.hpp>
#include <procman_lcm/output_t.hpp>

namespace fathom {
namespace {

template <class Message>
Message through_bytes(const Message& message) {
  std::vector<std::uint8_t> bytes(static_cast<std::size_t>(message.getEncodedSize()));
  message.encode(bytes.data(), 0, static_cast<int>(bytes.size()));
  Message back{};
  REQUIRE(back.decode(bytes.data(), 0, static_cast<int>(bytes.size())) == static_cast<int>(bytes.size()));
  return back;
}

template <class Message>
std::uint64_t fingerprint() {
  return static_cast<std::uint64_t>(Message::getHash());
}

const LaunchCommand kCommand{
    .id = "a", .exec = "prog -x", .group = "g/h", .auto_respawn = true, .stop_signal = 15, .stop_time_allowed = 3.5F};

}  // namespace

TEST_CASE("launch messages: have the fingerprints that procman's own programs send and expect") {
  CHECK(fingerprint<procman_lcm::orders_t>() == 0xd343f45b171ab855);
  CHECK(fingerprint<procman_lcm::deputy_info_t>() == 0x8876aeb040efd01f);
  CHECK(fingerprint<procman_lcm::discovery_t>() == 0xb1c83182bed74b95);
  CHECK(fingerprint<procman_lcm::output_t>() == 0x8efa5caf5da01eb3);
  CHECK(fingerprint<procman_lcm::cmd_t>() == 0x2277f449a855d330);
  CHECK(fingerprint<procman_lcm::cmd_desired_t>() == 0xb2a6c7a09ba54539);
  CHECK(fingerprint<procman_lcm::cmd_status_t>() == 0xa8e0208786cf86e3);
}

TEST_CASE("launch messages: orders come back as they were") {
  const LaunchOrders orders{.utime = 7, .deputy = "d", .sheriff = "s", .commands = {{kCommand, -3, true}}};
  const auto back = wire::decode(through_bytes(wire::encode(orders)));
  REQUIRE(back.has_value());
  CHECK(back->utime == 7);
  CHECK(back->deputy == "d");
  CHECK(back->sheriff == "s");
  REQUIRE(back->commands.size() == 1);
  CHECK(back->commands[0].command == kCommand);
  CHECK(back->commands[0].run == -3);
  CHECK(back->commands[0].stop);
}

TEST_CASE("launch messages: a deputy's word comes back as it was") {
  const DeputyInfo info{.utime = 8,
                        .deputy = "d",
                        .cpu_load = 0.5F,
                        .memory_total = 1LL << 40,
                        .memory_free = 2,
                        .swap_total = 3,
                        .swap_free = 4,
                        .commands = {{kCommand, 1234, 5, 768, 0.25F, 1LL << 41, 6}}};
  const auto back = wire::decode(through_bytes(wire::encode(info)));
  REQUIRE(back.has_value());
  CHECK(back->cpu_load == 0.5F);
  CHECK(back->memory_total == 1LL << 40);
  CHECK(back->memory_free == 2);
  CHECK(back->swap_total == 3);
  CHECK(back->swap_free == 4);
  REQUIRE(back->commands.size() == 1);
  CHECK(back->commands[0].command == kCommand);
  CHECK(back->commands[0].pid == 1234);
  CHECK(back->commands[0].run == 5);
  CHECK(back->commands[0].wait_status == 768);
  CHECK(back->commands[0].cpu == 0.25F);
  CHECK(back->commands[0].virtual_memory == 1LL << 41);
  CHECK(back->commands[0].resident_memory == 6);
}

TEST_CASE("launch messages: discovery and output come back as they were") {
  const auto discovery = wire::decode(through_bytes(wire::encode(LaunchDiscovery{9, "me", 77})));
  REQUIRE(discovery.has_value());
  CHECK(discovery->transmitter == "me");
  CHECK(discovery->nonce == 77);
  const LaunchOutput output{.utime = 10, .deputy = "d", .texts = {{"a", "one\r\n"}, {"", "two"}}};
  const auto back = wire::decode(through_bytes(wire::encode(output)));
  REQUIRE(back.has_value());
  REQUIRE(back->texts.size() == 2);
  CHECK(back->texts[0].id == "a");
  CHECK(back->texts[0].text == "one\r\n");
  CHECK(back->texts[1].id.empty());
}

TEST_CASE("launch messages: numbers that are none, lengths that lie and cut bytes are refused") {
  auto orders = wire::encode(LaunchOrders{.commands = {{kCommand, 1, false}}});
  orders.cmds[0].cmd.stop_time_allowed = std::numeric_limits<float>::quiet_NaN();
  CHECK_FALSE(wire::decode(orders).has_value());
  auto info = wire::encode(DeputyInfo{.commands = {{kCommand}}});
  info.ncmds = 2;
  CHECK_FALSE(wire::decode(info).has_value());
  const auto good = wire::encode(LaunchOrders{.deputy = "d", .commands = {{kCommand, 1, false}}});
  std::vector<std::uint8_t> bytes(static_cast<std::size_t>(good.getEncodedSize()));
  good.encode(bytes.data(), 0, static_cast<int>(bytes.size()));
  for (std::size_t length = 0; length < bytes.size(); ++length) {
    procman_lcm::orders_t cut{};
    const int size = static_cast<int>(length);
    CHECK(cut.decode(bytes.data(), 0, size) != size);
  }
  const std::size_t count = 8 + 8 + 4 + 2 + 4 + 1;  // fingerprint, time, two strings: then the number of commands
  for (const unsigned high : {0x7FU, 0xFFU}) {
    auto huge = bytes;
    huge[count] = static_cast<std::uint8_t>(high);
    procman_lcm::orders_t message{};
    CHECK(message.decode(huge.data(), 0, static_cast<int>(huge.size())) < 0);
  }
}

}  // namespace fathom
