// Every command that takes a recorded run, on a log of every kind that the repository can make: a result and exit code
// 0, or one clear line, exit code 1 and nothing written.
#include <doctest/doctest.h>

#include <cmath>
#include <filesystem>
#include <map>
#include <vector>

#include "common/wire/log_writer.hpp"
#include "test/support/full_trial.hpp"
#include "test/support/scratch.hpp"
#include "test/support/shell.hpp"
#include "test/support/trial_recording.hpp"
#include "test/support/virtual_dive.hpp"

namespace fathom {
namespace {

using test::file;
using test::program;
using test::Scratch;
using test::shell;

constexpr double kFlown = 30.0;  // s: yaw, or most of it

const std::string kLbv = file("config/vehicles/seabotix_lbv150.yaml");
const std::string kBeluga = file("config/vehicles/beluga.yaml");
const std::string kPap = file("config/vehicles/pap104_half.yaml");

/// One recording and what a user would name beside it.
struct Kind {
  std::string log, vehicle{kLbv}, site{file("config/sites/tank.yaml")}, more{};  ///< `more`: --map
};

/// A table as a stranger writes it: what it holds nobody has said.
std::string foreign_table() {
  std::string text = "time,x,y,z,yaw,u,v,r,fx,fy,mz\n";
  for (int k = 0; k < 400; ++k) {
    const double t = 0.1 * k, u = 0.3 + 0.1 * std::sin(0.5 * t), r = 0.1 * std::cos(0.3 * t);
    for (const double value : {t, 0.3 * t, 0.1 * t, 1.0, 0.33 * std::sin(0.3 * t), u, 0.0, r, 10.0 * u, 0.1})
      text += std::to_string(value) + ",";
    text += std::to_string(0.5 * r) + "\n";
  }
  return text;
}

std::string manoeuvre_log(const Scratch& scratch) {
  const model::Manoeuvre manoeuvre{.kind = model::ManoeuvreKind::kZigzag, .duration = 40.0, .difference = 4.5};
  std::string path = scratch.path("pap.lcmlog");
  wire::write_log(test::record_trial(test::vehicle_from_repository("pap104_half"),
                                     test::instruments_from_repository("pap104_half"), {.manoeuvre = manoeuvre})
                      .recording,
                  path);
  return path;
}

/// Logs that hold next to nothing, which every command must refuse.
std::map<std::string, Kind> poor_logs(const Scratch& scratch) {
  wire::write_log(Recording{.process_info = {{.process = "recorder"}}}, scratch.path("bare.lcmlog"));
  test::write_bytes(scratch.path("empty.lcmlog"), "");
  test::write_bytes(scratch.path("foreign.csv"), foreign_table());
  return {{"bare", {scratch.path("bare.lcmlog")}},
          {"empty", {scratch.path("empty.lcmlog")}},
          {"foreign", {scratch.path("foreign.csv"), kBeluga}}};
}

/// A live trial in the tank, the same where neither supervisor nor identifier was recorded, and the first 60 % of it as
/// a recorder leaves it that was switched off; one in deep water.
std::map<std::string, Kind> live_logs(const Scratch& scratch) {
  Recording tank, deep;
  static_cast<void>(test::run_trial({.seed = 24, .limit = kFlown, .recording = &tank}));
  static_cast<void>(test::run_trial({.seed = 24, .limit = kFlown, .site = "deep", .recording = &deep}));
  wire::write_log(tank, scratch.path("tank.lcmlog"));
  wire::write_log(deep, scratch.path("deep.lcmlog"));
  const std::string whole = test::read_bytes(scratch.path("tank.lcmlog"));
  test::write_bytes(scratch.path("cut.lcmlog"), whole.substr(0, whole.size() * 6 / 10 + 7));
  tank.excitation.clear();
  tank.model.clear();
  wire::write_log(tank, scratch.path("quiet.lcmlog"));
  return {{"tank", {scratch.path("tank.lcmlog")}},
          {"quiet", {scratch.path("quiet.lcmlog")}},
          {"cut", {scratch.path("cut.lcmlog")}},
          {"deep", {scratch.path("deep.lcmlog"), kLbv, file("config/sites/deep.yaml")}}};
}

/// What was recorded without Fathom's estimator: a manoeuvre with ranges, and Beluga under motion capture, as a table
/// with its map and as the log that fathom import makes of it.
std::map<std::string, Kind> recorded_logs(const Scratch& scratch) {
  const std::string table = file("test/data/beluga/yaw-1.csv"), map = " --map " + file("config/maps/beluga.yaml");
  const auto ran = shell(program("fathom") + " import " + table + map + " --out " + scratch.path("imported.lcmlog"));
  REQUIRE_MESSAGE(ran.code == 0, ran.text);
  return {{"pap", {manoeuvre_log(scratch), kPap, file("config/sites/pap104_half.yaml")}},
          {"table", {table, kBeluga, file("config/sites/tank.yaml"), map}},
          {"imported", {scratch.path("imported.lcmlog"), kBeluga}}};
}

/// What a command must say of a kind of log: "=" a result, "!" one line and nothing written.
using Row = std::pair<std::string, std::map<std::string, std::string>>;

void replace(std::string& text, const std::string& what, const std::string& by) {
  for (std::size_t at = 0; (at = text.find(what, at)) != std::string::npos; at += by.size())
    text.replace(at, what.size(), by);
}

void check_table(const Scratch& scratch, const std::map<std::string, Kind>& kinds, const std::vector<Row>& rows) {
  const std::string out = scratch.path("out");
  for (const auto& [pattern, cells] : rows) {
    for (const auto& [name, kind] : kinds) {
      REQUIRE_MESSAGE(cells.contains(name), pattern << " says nothing of " << name);
      std::string command = pattern;
      for (const auto& [what, by] : std::map<std::string, std::string>{{"LOG", kind.log + kind.more},
                                                                       {"RUN", kind.log},
                                                                       {"VEHICLE", "--vehicle " + kind.vehicle},
                                                                       {"SITE", "--site " + kind.site},
                                                                       {"OUT", "--out " + out}})
        replace(command, what, by);
      CAPTURE(command);
      std::filesystem::remove_all(out);
      const auto ran = shell(program("fathom") + " " + command);
      const std::string& cell = cells.at(name);
      const bool refused = cell.front() == '!';
      CHECK_MESSAGE(ran.code == (refused ? 1 : 0), ran.text);
      CHECK_MESSAGE(ran.says(cell.substr(1)), ran.text);
      const bool writes = pattern.find("OUT") != std::string::npos;
      CHECK(std::filesystem::exists(out) == (writes && !refused));
      if (!refused) continue;
      const std::size_t line = ran.text.rfind("fathom: ");
      CHECK_MESSAGE((line != std::string::npos && ran.text.find('\n', line) == ran.text.size() - 1), ran.text);
    }
  }
}

}  // namespace

TEST_CASE("every command: a log that holds nothing, or a table that nobody has described, is refused in one line") {
  const Scratch scratch;
  const std::string none = "!no LCM log", column = "!column 't'";
  check_table(
      scratch, poor_logs(scratch),
      {{"info RUN", {{"bare", "=PROCESS_INFO"}, {"empty", none}, {"foreign", "!fathom import"}}},
       {"export LOG --to csv OUT", {{"bare", "=PROCESS_INFO"}, {"empty", none}, {"foreign", column}}},
       {"check LOG VEHICLE", {{"bare", "!"}, {"empty", none}, {"foreign", column}}},
       {"diagnose VEHICLE --train LOG OUT", {{"bare", "!"}, {"empty", none}, {"foreign", column}}},
       {"smooth LOG OUT", {{"bare", "!"}, {"empty", none}, {"foreign", column}}},
       {"regress RUN VEHICLE", {{"bare", "!no section hydrodynamics"}, {"empty", none}, {"foreign", column}}},
       {"methods VEHICLE --train LOG", {{"bare", "!"}, {"empty", none}, {"foreign", column}}},
       {"trial RUN VEHICLE SITE OUT", {{"bare", "!no STATE"}, {"empty", none}, {"foreign", "!fathom import"}}},
       {"compare RUN RUN", {{"bare", "!no MODEL"}, {"empty", none}, {"foreign", "!fathom import"}}},
       {"repair-log RUN OUT", {{"bare", "=no damage"}, {"empty", "!no whole event"}, {"foreign", "!no whole event"}}}});
}

TEST_CASE("every command: logs of live trials, whole, cut off, and without supervisor and identifier") {
  const Scratch scratch;
  const auto all = [](const std::string& cell) {
    return std::map<std::string, std::string>{{"tank", cell}, {"quiet", cell}, {"cut", cell}, {"deep", cell}};
  };
  check_table(
      scratch, live_logs(scratch),
      {{"info RUN", all("=STATE")},
       {"export LOG --to npz OUT", all("=STATE")},
       {"check LOG VEHICLE",
        {{"tank", "=optical_flow"}, {"quiet", "=optical_flow"}, {"cut", "=optical_flow"}, {"deep", "=gyro.r"}}},
       {"smooth LOG OUT", {{"tank", "=laser"}, {"quiet", "=laser"}, {"cut", "=laser"}, {"deep", "=range north"}}},
       {"regress RUN VEHICLE", all("!no section hydrodynamics")},
       {"trial RUN VEHICLE SITE OUT",
        {{"tank", "=yaw"}, {"quiet", "=no EXCITATION"}, {"cut", "=yaw"}, {"deep", "=yaw"}}},
       {"compare RUN RUN",
        {{"tank", "=equal to the last bit"},
         {"quiet", "!no MODEL"},
         {"cut", "=equal to the last bit"},
         {"deep", "=equal to the last bit"}}},
       {"repair-log RUN OUT",
        {{"tank", "=no damage"}, {"quiet", "=no damage"}, {"cut", "=bytes"}, {"deep", "=no damage"}}}});
}

TEST_CASE("every command: recordings that no estimator of Fathom has seen") {
  const Scratch scratch;
  const auto recorded = recorded_logs(scratch);
  check_table(
      scratch, recorded,
      {{"export LOG --to csv OUT", {{"pap", "=RANGES"}, {"table", "=POSE_CAPTURE"}, {"imported", "=POSE_CAPTURE"}}},
       {"check LOG VEHICLE", {{"pap", "="}, {"table", "=dvl"}, {"imported", "=dvl"}}},
       {"smooth LOG OUT",
        {{"pap", "!nothing that is known tells the position"},
         {"table", "=pose position"},
         {"imported", "=pose position"}}},
       {"regress LOG VEHICLE",
        {{"pap", "!nothing that is known tells the position"},
         {"table", "!no section hydrodynamics"},
         {"imported", "!no section hydrodynamics"}}},
       {"methods VEHICLE --train LOG",
        {{"pap", "!nothing that is known tells the position"},
         {"table", "=complementary filter, re"},
         {"imported", "=complementary filter, re"}}},
       {"trial RUN VEHICLE SITE OUT", {{"pap", "!no STATE"}, {"table", "!fathom import"}, {"imported", "!no STATE"}}},
       {"compare RUN RUN", {{"pap", "!no MODEL"}, {"table", "!fathom import"}, {"imported", "!no MODEL"}}}});
}

TEST_CASE("every command: what fathom smooth writes is a log for all the others") {
  const Scratch scratch;
  const std::string config = " --config " + file("config/pipelines/pap104_half.yaml"),
                    smoothed = scratch.path("pap.s.lcmlog");
  const auto ran = shell(program("fathom") + " smooth " + manoeuvre_log(scratch) + config + " --out " + smoothed);
  REQUIRE_MESSAGE(ran.code == 0, ran.text);
  const std::map<std::string, Kind> kinds{{"smoothed", {smoothed, kPap, file("config/sites/pap104_half.yaml"), ""}}};
  check_table(scratch, kinds,
              {{"smooth LOG OUT" + config, {{"smoothed", "=range A"}}},
               {"regress RUN VEHICLE", {{"smoothed", "=surge"}}},
               {"trial RUN VEHICLE SITE OUT", {{"smoothed", "=no EXCITATION"}}},
               {"methods VEHICLE --train LOG" + config, {{"smoothed", "=Kalman smoother, recursi"}}}});
}

}  // namespace fathom
