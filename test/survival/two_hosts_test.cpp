// Two hosts as two network namespaces joined by a cable of 2 Mbit/s that loses one packet in a hundred and is cut for
// ten seconds: the vehicle carries on, loses nothing that it records, sends no picture across, and the shore sees all
// again as soon as the cable is back.
#include <doctest/doctest.h>

#include <algorithm>
#include <filesystem>
#include <iterator>

#include "common/base/event_log.hpp"
#include "common/wire/log_reader.hpp"
#include "test/support/private_network.hpp"

namespace fathom {
namespace {

long pictures_in(const std::string& path) {
  long count = 0;
  EventLog log{path};
  while (const auto event = log.next()) count += event->channel == "CAMERA" ? 1 : 0;
  return count;
}

}  // namespace

TEST_CASE("two hosts: a trial goes on while the cable is cut, and the sheriff sees it again within two seconds") {
  if (!test::private_network()) return;
  if (test::shell("unshare -rn ip link add here type veth peer name there").code != 0) {
    MESSAGE("skipped: this kernel makes no veth pairs");
    return;
  }
  const test::Scratch scratch;
  std::filesystem::create_directory(scratch.path("pictures"));
  for (const char* picture : {"0018.png", "0019.png"}) {
    std::filesystem::copy(std::string{FATHOM_SOURCE_DIR} + "/test/data/images/tank_tag16h5/" + picture,
                          scratch.path("pictures"));
  }
  test::write_bytes(scratch.path("camera.yaml"),
                    "camera_driver: {camera: down, pictures: pictures, rate: 10 Hz, repeat: true}\n");
  const std::string cable = std::string{"'"} + FATHOM_BINARY_DIR + "/test/test_cable'";
  const auto ran = test::on_a_network(
      scratch,
      // This namespace is the vehicle; the other ones are the shore and what lies between.
      "unshare -n sleep 1000 & shore=$!; unshare -n sleep 1000 & between=$!\n"
      "for i in $shore $between; do until [ \"$(readlink /proc/$i/ns/net)\" != \"$(readlink /proc/$$/ns/net)\" ]; do "
      "sleep 0.02; done; done\n"
      "on_shore() { nsenter -t $shore -n \"$@\"; }\n"
      "ip link add cable type veth peer name left; ip link add end type veth peer name right\n"
      "ip link set left netns $between; ip link set right netns $between; ip link set end netns $shore\n"
      "ip addr add 10.77.0.1/24 dev cable; ip link set cable up\n"
      "ip route del 224.0.0.0/4; ip route add 224.0.0.0/4 dev cable\n"
      "on_shore ip link set lo up; on_shore ip addr add 10.77.0.2/24 dev end; on_shore ip link set end up\n"
      "on_shore ip route add 224.0.0.0/4 dev end\n"
      "nsenter -t $between -n ip link set left up; nsenter -t $between -n ip link set right up\n"
      "nsenter -t $between -n " +
          cable +
          " left right 2e6 0.01 >cable.txt & cable=$!\n"
          "export LCM_DEFAULT_URL='udpm://239.255.76.67:7667?ttl=1&recv_buf_size=2097152'\n"
          "export FATHOM_SIMULATION='--duration 25 --speed 1 --seed 4 --order 2=identify'\n"
          "$deputy -i vehicle 2>vehicle.txt & d=$!\n"
          "on_shore $deputy -i topside 2>topside.txt & e=$!\n"
          "up vehicle.txt; up topside.txt\n"
          "${deputy%deputy}camera_driver --config camera.yaml >camera.txt 2>&1 & c=$!\n"
          "nsenter -t $shore -n ${deputy%deputy}recorder --file shore.lcmlog & l=$!\n"
          "on_shore $sheriff $configs/tank.cfg --script simulated-trial >sheriff.txt & s=$!\n"
          "until_new fathom-simulator ''; sleep 5\n"
          "kill -USR1 $cable; sleep 10\n"
          "kill -USR2 $cable; t=$(date +%s%N)\n"
          "seen() { tac sheriff.txt | sed '/deputy lost/q' | grep -q 'simulator on vehicle: running'; }\n"
          "while kill -0 $s && ! seen; do sleep 0.02; done\n"
          "echo \"whole after $((($(date +%s%N) - t) / 1000000)) ms\"\n"
          "wait $s; echo \"code $?\"; kill $c $l $cable; wait $c $l $cable; cat sheriff.txt cable.txt "
          "camera.txt\n",
      120);
  CHECK_MESSAGE(ran.says("code 0"), ran.text);
  CHECK(ran.says("estimator on vehicle: deputy lost"));
  const auto whole = ran.text.find("whole after ");
  REQUIRE(whole != std::string::npos);
  CHECK_MESSAGE(std::stol(ran.text.substr(whole + 12)) < 2000, ran.text);
  MESSAGE(ran.text.substr(whole, ran.text.find('\n', whole) - whole));
  CHECK_MESSAGE(ran.says("carried"), ran.text);

  const Recording run = wire::read_log(scratch.path("trial.lcmlog.00")).recording;
  REQUIRE(run.ahrs.size() > 100);
  constexpr double kRate = 100.0;  // Hz, of the simulated instrument
  const double seconds = seconds_between(run.ahrs.front().utime, run.ahrs.back().utime);
  CHECK(seconds > 24.0);
  const double lost = kRate * seconds + 1.0 - static_cast<double>(run.ahrs.size());
  CHECK(lost < 3.0);  // of 2500; the instrument's own clock is rounded
  CHECK(run.excitation.back().phase != "aborted");

  // Ten pictures a second are more than the cable carries: none is on it, and the rest has room. One packet in a
  // hundred is lost by intent; a relay that waits for the processor loses more.
  constexpr double kMost = 0.5;
  CHECK(pictures_in(scratch.path("trial.lcmlog.00")) > 100);
  const Recording shore = wire::read_log(scratch.path("shore.lcmlog")).recording;
  CHECK(pictures_in(scratch.path("shore.lcmlog")) == 0);
  const auto cut = std::adjacent_find(shore.state.begin(), shore.state.end(), [](const auto& a, const auto& b) {
    return seconds_between(a.utime, b.utime) > 5.0;
  });
  REQUIRE(cut != shore.state.end());
  const Utime from = cut->utime, to = std::next(cut)->utime;
  const auto across = std::count_if(run.state.begin(), run.state.end(),
                                    [&](const auto& each) { return each.utime <= from || each.utime >= to; });
  MESSAGE("STATE on the shore: " << shore.state.size() << " of " << across << ", cut for " << seconds_between(from, to)
                                 << " s");
  CHECK(static_cast<double>(shore.state.size()) > (1.0 - kMost) * static_cast<double>(across));
  CHECK(seconds_between(from, to) < 12.0);
}

}  // namespace fathom
