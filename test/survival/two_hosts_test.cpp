// Two hosts as two network namespaces joined by a cable of 2 Mbit/s that is cut for ten seconds: the vehicle carries
// on, loses nothing that it records, and the shore sees all again as soon as the cable is back.
#include <doctest/doctest.h>

#include "common/wire/log_reader.hpp"
#include "test/support/private_network.hpp"

namespace fathom {

TEST_CASE("two hosts: a trial goes on while the cable is cut, and the sheriff sees it again within two seconds") {
  if (!test::private_network()) return;
  if (test::shell("unshare -rn ip link add here type veth peer name there").code != 0) {
    MESSAGE("skipped: this kernel makes no veth pairs");
    return;
  }
  const test::Scratch scratch;
  const auto ran = test::on_a_network(
      scratch,
      // This namespace is the vehicle; the other one holds the shore's end of the cable.
      "unshare -n sleep 1000 & shore=$!; sleep 0.3\n"
      "on_shore() { nsenter -t $shore -n \"$@\"; }\n"
      "ip link add cable type veth peer name end; ip link set end netns $shore\n"
      "ip addr add 10.77.0.1/24 dev cable; ip link set cable up\n"
      "ip route del 224.0.0.0/4; ip route add 224.0.0.0/4 dev cable\n"
      "tc qdisc add dev cable root tbf rate 2mbit burst 32kb latency 200ms || echo unlimited\n"
      "on_shore ip link set lo up; on_shore ip addr add 10.77.0.2/24 dev end; on_shore ip link set end up\n"
      "on_shore ip route add 224.0.0.0/4 dev end\n"
      "export LCM_DEFAULT_URL='udpm://239.255.76.67:7667?ttl=1&recv_buf_size=2097152'\n"
      "export FATHOM_SIMULATION='--duration 25 --speed 1 --seed 4 --order 2=identify'\n"
      "$deputy -i vehicle 2>/dev/null & d=$!\n"
      "on_shore $deputy -i topside 2>/dev/null & e=$!\n"
      "sleep 1; on_shore $sheriff $configs/tank.cfg --script simulated-trial >sheriff.txt & s=$!\n"
      "until_new fathom-simulator ''; sleep 5\n"
      "on_shore ip link set end down; sleep 10\n"
      "on_shore ip link set end up; on_shore ip route add 224.0.0.0/4 dev end; t=$(date +%s%N)\n"
      "while ! tail -n 1 sheriff.txt | grep -q 'vehicle: running$'; do sleep 0.02; done\n"
      "echo \"whole after $((($(date +%s%N) - t) / 1000000)) ms\"\n"
      "wait $s; echo \"code $?\"; cat sheriff.txt\n",
      90);
  CHECK_MESSAGE(ran.says("code 0"), ran.text);
  CHECK(ran.says("estimator on vehicle: deputy lost"));
  const auto whole = ran.text.find("whole after ");
  REQUIRE(whole != std::string::npos);
  CHECK(std::stol(ran.text.substr(whole + 12)) < 2000);
  MESSAGE(ran.text.substr(whole, ran.text.find('\n', whole) - whole));

  const Recording run = wire::read_log(scratch.path("trial.lcmlog.00")).recording;
  REQUIRE(run.ahrs.size() > 100);
  constexpr double kRate = 100.0;  // Hz, of the simulated instrument
  const double seconds = seconds_between(run.ahrs.front().utime, run.ahrs.back().utime);
  CHECK(seconds > 24.0);
  const double lost = kRate * seconds + 1.0 - static_cast<double>(run.ahrs.size());
  CHECK(lost < 3.0);  // of 2500; the instrument's own clock is rounded
  CHECK(run.excitation.back().phase != "aborted");
}

}  // namespace fathom
