// What an operator has when something is wrong: fathom doctor, fathom repair-log, and words about a full disk.
#include <doctest/doctest.h>

#include "test/support/scratch.hpp"
#include "test/support/shell.hpp"

namespace fathom {
namespace {

using test::file;
using test::program;
using test::Scratch;
using test::shell;

std::string import_run(const Scratch& scratch) {
  const std::string log = scratch.path("run.lcmlog");
  const auto ran = shell(program("fathom") + " import " + file("test/data/beluga/yaw-1.csv") + " --map " +
                         file("config/maps/beluga.yaml") + " --out " + log);
  REQUIRE_MESSAGE(ran.code == 0, ran.text);
  return log;
}

}  // namespace

TEST_CASE("fathom repair-log: keeps what is before and behind the damage, counts it, and the result can be read") {
  const Scratch scratch;
  const std::string log = import_run(scratch), damaged = scratch.path("damaged.lcmlog"),
                    whole = scratch.path("whole.lcmlog");
  std::string bytes = test::read_bytes(log);
  bytes.replace(bytes.size() / 2, 300, std::string(300, '\xED'));
  bytes.resize(bytes.size() - 5);
  test::write_bytes(damaged, bytes);
  const std::string check = program("fathom") + " check --vehicle " + file("config/vehicles/beluga.yaml") + " ";
  const auto refused = shell(check + damaged);
  CHECK(refused.code == 1);
  CHECK_MESSAGE(refused.says("fathom repair-log LOG --out REPAIRED"), refused.text);
  const auto ran = shell(program("fathom") + " repair-log " + damaged + " --out " + whole);
  CHECK_MESSAGE(ran.code == 0, ran.text);
  CHECK(ran.says("2 damaged stretches"));
  CHECK(ran.says("DVL"));
  const auto again = shell(check + whole);
  CHECK_MESSAGE(again.code == 0, again.text);
  CHECK(shell(program("fathom") + " repair-log " + damaged + " --out " + whole).says("exists already"));
  CHECK(shell(program("fathom") + " repair-log " + whole + " --out " + scratch.path("x")).says("no damage"));
}

TEST_CASE("fathom doctor: names what is missing, with the command that mends it") {
  const Scratch scratch;
  test::write_bytes(scratch.path("drivers.yaml"),
                    "ahrs_driver: {link: 'serial:///dev/no-such-line?baud=9600'}\n"
                    "camera_driver: {camera: down, device: /dev/no-such-camera}\n");
  const auto ran = shell("PATH=/nowhere " + program("fathom") + " doctor --run /no/such/folder --config " +
                         scratch.path("drivers.yaml") + " --operator " + file("config/operators/simulated.yaml"));
  CHECK(ran.code == 1);
  CHECK_MESSAGE(ran.says("lcm-logger is missing (records); sudo apt-get install liblcm-bin"), ran.text);
  CHECK(ran.says("/no/such/folder: No such file or directory; mkdir -p /no/such/folder"));
  CHECK(ran.says("/dev/no-such-line is not there"));
  CHECK(ran.says("/dev/no-such-camera is not there"));
  CHECK(ran.says("the one that everybody knows"));
  if (shell("unshare -rn true").code != 0) return;
  const auto alone = shell("unshare -rn " + program("fathom") + " doctor");
  CHECK(alone.says("BAD   network      no route to LCM's multicast address; sudo ip link set lo up;"));
  const auto routed = shell("unshare -rn sh -c 'ip link set lo up; ip route add 224.0.0.0/4 dev lo; \"$0\" doctor' " +
                            program("fathom"));
  CHECK_MESSAGE(routed.says("ok    network      a message comes back over multicast"), routed.text);
  CHECK_MESSAGE(routed.says("what is sent to this host past the bus is refused"), routed.text);
}

TEST_CASE("disk: a process whose log cannot be written says so and fails") {
  const Scratch scratch;
  const std::string log = import_run(scratch);
  const std::string estimator = program("estimator") + " --log-level warning --config " +
                                file("config/pipelines/beluga.yaml") + " --config " +
                                file("config/corrections/none.yaml") + " --config " +
                                file("config/vehicles/beluga.yaml") + " --in file://" + log + " --out file://";
  const auto full = shell(estimator + "/dev/full");
  CHECK(full.code == 1);
  CHECK_MESSAGE(full.says("writing failed; is the disk full?"), full.text);
  const auto nowhere = shell(estimator + "/nowhere/out.lcmlog");
  CHECK(nowhere.code == 1);
  CHECK_MESSAGE(nowhere.says("cannot be written"), nowhere.text);
}

}  // namespace fathom
