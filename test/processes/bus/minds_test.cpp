// The minds as processes: what they hear and say, the same log twice, and the same log over the network.
#include <doctest/doctest.h>

#include <fstream>

#include "common/wire/log_reader.hpp"
#include "common/wire/log_writer.hpp"
#include "test/support/channels.hpp"
#include "test/support/scratch.hpp"
#include "test/support/shell.hpp"

namespace fathom {
namespace {

using test::file;
using test::program;
using test::Scratch;
using test::shell;

const std::string kConfig = " --log-level warning --config " + file("config/pipelines/beluga.yaml") + " --config " +
                            file("config/vehicles/beluga.yaml") + " --config " + file("config/corrections/none.yaml");

/// The first `seconds` of a measured run as a log.
void make_log(const Scratch& scratch, const std::string& name, int seconds) {
  std::ifstream from{std::string{FATHOM_SOURCE_DIR} + "/test/data/beluga/random-1.csv"};
  std::ofstream to{scratch.path(name + ".csv")};
  std::string line;
  for (int i = 0; i <= 10 * seconds && std::getline(from, line); ++i) to << line << "\n";
  to.close();
  const auto ran = shell(program("fathom") + " import " + scratch.path(name + ".csv") + " --map " +
                         file("config/maps/beluga.yaml") + " --out " + scratch.path(name + ".lcmlog"));
  REQUIRE_MESSAGE(ran.code == 0, ran.text);
}

}  // namespace

TEST_CASE("minds: each hears and says what docs/messages.md tells") {
  const std::string trial = " --config " + file("config/pipelines/tank.yaml") + " --config " +
                            file("config/vehicles/seabotix_lbv150.yaml") + " --config " +
                            file("config/sites/tank.yaml") + " --config " + file("config/operators/simulated.yaml");
  for (const std::string process : {"estimator", "identifier", "diagnoser", "supervisor", "estimator of a trial"}) {
    CAPTURE(process);
    const std::string name = process.substr(0, process.find(' '));
    const bool live = process != name || process == "supervisor";
    const auto ran = shell(program(name) + (live ? trial : kConfig) + " --interface");
    REQUIRE_MESSAGE(ran.code == 0, ran.text);
    const test::Channels actual = test::channels_of(ran.text);
    const test::Channels stated = test::channels_in_docs(name);
    CHECK(actual.hears == stated.hears);
    CHECK(actual.says == stated.says);
  }
}

TEST_CASE("minds: the same log in gives the same bytes out") {
  const Scratch scratch;
  make_log(scratch, "run", 180);
  const std::string run = " --in file://" + scratch.path("run.lcmlog");
  for (const std::string turn : {"1", "2"}) {
    const std::string state = scratch.path("state" + turn + ".lcmlog");
    const auto estimator = shell(program("estimator") + kConfig + run + " --out file://" + state);
    REQUIRE_MESSAGE(estimator.code == 0, estimator.text);
    for (const std::string mind : {"identifier", "diagnoser"}) {
      const auto ran = shell(program(mind) + kConfig + run + " --in file://" + state + " --out file://" +
                             scratch.path(mind + turn + ".lcmlog"));
      REQUIRE_MESSAGE(ran.code == 0, ran.text);
    }
  }
  for (const std::string name : {"state", "identifier", "diagnoser"}) {
    CAPTURE(name);
    CHECK(test::read_bytes(scratch.path(name + "1.lcmlog")) == test::read_bytes(scratch.path(name + "2.lcmlog")));
  }
  CHECK(wire::read_log(scratch.path("state1.lcmlog")).recording.state.size() > 1000);
  CHECK(wire::read_log(scratch.path("identifier1.lcmlog")).recording.model.size() > 100);
  CHECK(wire::read_log(scratch.path("diagnoser1.lcmlog")).recording.effects.size() > 3);
}

TEST_CASE("minds: a log replayed over the network gives the parameters of the log read directly") {
  if (shell("unshare -rn ip link set lo up").code != 0) {
    MESSAGE("skipped: this machine allows no private network (unshare -rn)");
    return;
  }
  const Scratch scratch;
  make_log(scratch, "run", 120);
  const auto ran = shell("FATHOM_BIN=" + std::string{FATHOM_BINARY_DIR} + "/bin FATHOM_REPLAY_SPEED=40 " +
                         file("scripts/replay") + " " + scratch.path("run.lcmlog") + " " + scratch.path("replay") +
                         " " + file("config/pipelines/beluga.yaml") + " " + file("config/corrections/none.yaml") + " " +
                         file("config/vehicles/beluga.yaml"));
  CHECK_MESSAGE(ran.code == 0, ran.text);
  CHECK_MESSAGE(ran.says("equal to the last bit"), ran.text);
}

}  // namespace fathom
