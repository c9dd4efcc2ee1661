// Another host on the network of the vehicle, as a second network namespace: with ttl=0 nothing that it sends is
// believed, with ttl=1 what it sends to the bus and nothing else; and the firewall's rules of docs/operations.md keep
// programs of other makers as safe.
#include <doctest/doctest.h>

#include <algorithm>
#include <fstream>
#include <map>
#include <string>

#include "common/base/event_log.hpp"
#include "test/support/private_network.hpp"

namespace fathom {
namespace {

std::map<std::string, int> messages_in(const std::string& path) {
  std::map<std::string, int> count;
  EventLog log{path};
  while (const auto event = log.next()) ++count[std::string{event->channel}];
  return count;
}

/// This namespace is the vehicle (10.77.0.1), $stranger the other host (10.77.0.2); `send CHANNEL ADDRESS` sends five
/// messages as LCM writes them. bash's own multicast has a ttl of 1.
constexpr char kTwoHosts[] =
    "unshare -n sleep 1000 & stranger=$!\n"
    "until [ \"$(readlink /proc/$stranger/ns/net)\" != \"$(readlink /proc/$$/ns/net)\" ]; do sleep 0.02; done\n"
    "ip link add cable type veth peer name end; ip link set end netns $stranger\n"
    "ip addr add 10.77.0.1/24 dev cable; ip link set cable up\n"
    "on_stranger() { nsenter -t $stranger -n \"$@\"; }\n"
    "on_stranger ip link set lo up; on_stranger ip addr add 10.77.0.2/24 dev end; on_stranger ip link set end up\n"
    "on_stranger ip route add 224.0.0.0/4 dev end\n"
    "cat >send <<'END'\n"
    "for i in 1 2 3 4 5; do printf \"LC02\\\\0\\\\0\\\\0\\\\$i$1\\\\00012345678\" >/dev/udp/$2/7667; sleep 0.02; done\n"
    "END\n"
    "listens() { within 20 grep -q ':1DF3 ' /proc/net/udp; sleep 1; }\n"  // port 7667
    "attack() { bash send OWN 239.255.76.67; on_stranger bash send PAST_THE_BUS 10.77.0.1; "
    "on_stranger bash send FROM_OUTSIDE 239.255.76.67; bash send OWN 239.255.76.67; sleep 1; }\n"
    "record() { LCM_DEFAULT_URL=\"udpm://239.255.76.67:7667?ttl=$2\" ${deputy%deputy}recorder --file $1 & r=$!; "
    "listens; attack; kill $r; wait $r; }\n";

bool two_hosts() {
  if (!test::private_network()) return false;
  if (test::shell("unshare -rn ip link add here type veth peer name there").code == 0) return true;
  MESSAGE("skipped: this kernel makes no veth pairs");
  return false;
}

}  // namespace

TEST_CASE("strangers: with ttl=0 nothing from another host is believed, with ttl=1 only what was sent to the bus") {
  if (!two_hosts()) return;
  const test::Scratch scratch;
  const auto ran =
      test::on_a_network(scratch, std::string{kTwoHosts} +
                                      "ip route del 224.0.0.0/4; ip route add 224.0.0.0/4 dev lo src 127.0.0.1\n"
                                      "record by_lo.lcmlog 0\n"
                                      "ip route del 224.0.0.0/4; ip route add 224.0.0.0/4 dev cable\n"
                                      "record by_cable.lcmlog 0\n"
                                      "record two_hosts.lcmlog 1\n");
  // lo carries the bus, or the cable does, which then brings what the other host sends to the same address.
  for (const char* log : {"by_lo.lcmlog", "by_cable.lcmlog"}) {
    CAPTURE(log);
    auto heard = messages_in(scratch.path(log));
    CHECK_MESSAGE(heard["OWN"] == 10, ran.text);
    CHECK(heard["PAST_THE_BUS"] == 0);
    CHECK(heard["FROM_OUTSIDE"] == 0);
  }
  auto heard = messages_in(scratch.path("two_hosts.lcmlog"));
  CHECK_MESSAGE(heard["OWN"] == 10, ran.text);
  CHECK(heard["PAST_THE_BUS"] == 0);
  CHECK(heard["FROM_OUTSIDE"] == 5);
}

TEST_CASE("strangers: the firewall's rules of docs/operations.md guard programs that are not of Fathom") {
  if (!two_hosts()) return;
  if (test::shell("unshare -rn nft list ruleset").code != 0) {
    MESSAGE("skipped: nft is not installed, or may do nothing here");
    return;
  }
  // The rules as they are printed there, one host's and two hosts'.
  std::ifstream page{std::string{FATHOM_SOURCE_DIR} + "/docs/operations.md"};
  std::string one_host, two_hosts;
  for (std::string line; std::getline(page, line);) {
    if (!line.starts_with("sudo nft 'add rule")) continue;
    const std::string rule = line.substr(5, line.find("  #") - 5);
    (rule.find("ip daddr") == std::string::npos ? one_host : two_hosts) = rule;
  }
  REQUIRE_FALSE(one_host.empty());
  REQUIRE_FALSE(two_hosts.empty());
  std::string there = two_hosts;
  there.replace(there.find("eth0"), 4, "cable");
  const test::Scratch scratch;
  const std::string logger = "lcm-logger -q";
  const auto record = [&](const std::string& name, const std::string& rule) {
    return "nft flush ruleset; nft add table inet filter; nft add chain inet filter input '{ type filter hook input "
           "priority 0; policy accept; }'\n" +
           rule + "\n" + logger + " -f " + name + " & r=$!\nlistens; attack; kill $r; wait $r\n";
  };
  const auto ran = test::on_a_network(
      scratch, std::string{kTwoHosts} + "ip route del 224.0.0.0/4; ip route add 224.0.0.0/4 dev lo src 127.0.0.1\n" +
                   record("bare.lcmlog", "") + record("one.lcmlog", one_host) +
                   "ip route del 224.0.0.0/4; ip route add 224.0.0.0/4 dev cable\n" + record("two.lcmlog", there));
  CHECK_MESSAGE(messages_in(scratch.path("bare.lcmlog"))["PAST_THE_BUS"] == 5, ran.text);  // what the rules are against
  auto one = messages_in(scratch.path("one.lcmlog")), two = messages_in(scratch.path("two.lcmlog"));
  CHECK_MESSAGE(one["OWN"] == 10, ran.text);
  CHECK(one["PAST_THE_BUS"] == 0);
  CHECK(one["FROM_OUTSIDE"] == 0);
  CHECK_MESSAGE(two["OWN"] == 10, ran.text);
  CHECK(two["PAST_THE_BUS"] == 0);
  CHECK(two["FROM_OUTSIDE"] == 5);
}

}  // namespace fathom
