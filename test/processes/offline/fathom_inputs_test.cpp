// The offline tool's inputs when they are damaged: what is told, what is kept, and that nothing is lost.
#include <doctest/doctest.h>

#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

#include "test/support/offline_tool.hpp"

namespace fathom {
namespace {

using test::kOfflineTool;
using test::kSledFile;
using test::one_line;
using test::Ran;
using test::Scratch;
using test::shell;
using test::table;

}  // namespace

TEST_CASE("fathom: an import that fails leaves the log that was there, and nothing beside it") {
  const Scratch scratch;
  const std::string header = "t,x,y,z,phi,theta,psi,u,v,w,p,q,r";
  test::write_bytes(scratch.path("good.csv"), table(header));
  std::string broken;  // not one depth
  std::istringstream lines{table(header)};
  for (std::string line; std::getline(lines, line);) broken += line + (broken.empty() ? ",depth\n" : ",\n");
  test::write_bytes(scratch.path("bad.csv"), broken);
  const std::string out = scratch.path("run.lcmlog");
  REQUIRE(shell(kOfflineTool + " import " + scratch.path("good.csv") + " --out " + out).code == 0);
  const std::string before = test::read_bytes(out);
  CHECK(shell(kOfflineTool + " import " + scratch.path("bad.csv") + " --out " + out).code == 1);
  CHECK(test::read_bytes(out) == before);
  CHECK_FALSE(std::filesystem::exists(out + ".part"));
}

TEST_CASE("fathom: a NaN cell costs its sample, and is counted") {
  const Scratch scratch;
  test::write_bytes(scratch.path("a.csv"), table("t,x,y,z,u,v,w,X,Y,Z,K,M,N", "nan"));
  const Ran ran = shell(kOfflineTool + " import " + scratch.path("a.csv") + " --out " + scratch.path("a.lcmlog"));
  CAPTURE(ran.text);
  CHECK(ran.code == 0);
  CHECK(ran.says("DVL 299"));
  CHECK(ran.says("POSE_CAPTURE 300"));
  CHECK(ran.says("dvl: 1 "));
}

TEST_CASE("fathom: a log cut in its last message is read with a warning, one damaged inside is refused") {
  const Scratch scratch;
  test::write_bytes(scratch.path("v.yaml"), kSledFile);
  test::write_bytes(scratch.path("a.csv"), table("t,x,y,z,u,v,w,X,Y,Z,K,M,N"));
  REQUIRE(shell(kOfflineTool + " import " + scratch.path("a.csv") + " --out " + scratch.path("a.lcmlog")).code == 0);
  std::string bytes = test::read_bytes(scratch.path("a.lcmlog"));
  test::write_bytes(scratch.path("cut.lcmlog"), bytes.substr(0, bytes.size() - 20));
  const std::string check = kOfflineTool + " check --vehicle " + scratch.path("v.yaml") + " ";
  const Ran cut = shell(check + scratch.path("cut.lcmlog"));
  CAPTURE(cut.text);
  CHECK(cut.code == 0);
  CHECK(cut.says("cut.lcmlog: byte"));
  bytes[bytes.size() / 2] = 'x';
  for (std::size_t i = bytes.size() / 2; i < bytes.size() / 2 + 200; ++i) bytes[i] = 'x';
  test::write_bytes(scratch.path("bad.lcmlog"), bytes);
  one_line(shell(check + scratch.path("bad.lcmlog")), 1, "bad.lcmlog: byte");
}

TEST_CASE("fathom: logs that were joined are refused with the place, and parted into what they were") {
  const Scratch scratch;
  test::write_bytes(scratch.path("v.yaml"), kSledFile);
  test::write_bytes(scratch.path("a.csv"), table("t,x,y,z,u,v,w,X,Y,Z,K,M,N"));
  REQUIRE(shell(kOfflineTool + " import " + scratch.path("a.csv") + " --out " + scratch.path("a.lcmlog")).code == 0);
  const std::string one = test::read_bytes(scratch.path("a.lcmlog"));
  test::write_bytes(scratch.path("joined.lcmlog"), one + one);
  const std::string check = kOfflineTool + " check --vehicle " + scratch.path("v.yaml") + " ";
  one_line(shell(check + scratch.path("joined.lcmlog")), 1, "holds several recordings joined together");
  const Ran parted =
      shell(kOfflineTool + " repair-log " + scratch.path("joined.lcmlog") + " --out " + scratch.path("p.lcmlog"));
  CAPTURE(parted.text);
  CHECK(parted.code == 0);
  CHECK(parted.says("2 recordings joined together"));
  CHECK(test::read_bytes(scratch.path("p-1.lcmlog")) == one);
  CHECK(test::read_bytes(scratch.path("p-2.lcmlog")) == one);
}

TEST_CASE("fathom: check writes the map as it should be, and with it the tables agree") {
  const Scratch scratch;
  const std::string data = test::file("test/data/conventions/enu_position.csv"), fixed = scratch.path("mended.yaml");
  test::write_bytes(
      scratch.path("v.yaml"),
      "name: rov\ndof: [surge, sway, heave, roll, pitch, yaw]\nmass: 12 kg\nwater_density: 1000 kg/m^3\n");
  const std::string check = kOfflineTool + " check --vehicle " + scratch.path("v.yaml") + " " + data;
  const Ran wrong = shell(check + " --write-map " + fixed);
  CAPTURE(wrong.text);
  CHECK(wrong.code == 0);
  CHECK(wrong.says("frame: ENU"));
  const Ran right = shell(check + " --map " + fixed);
  CAPTURE(right.text);
  CHECK(right.code == 0);
  CHECK_FALSE(right.says("corrected"));
}

}  // namespace fathom
