// The offline tool: what bad input prints, and a whole diagnosis of a small made-up vehicle.
#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <random>
#include <sstream>
#include <string>
#include <vector>

#include "common/tables/writer.hpp"
#include "test/support/offline_tool.hpp"
#include "test/support/schema.hpp"
#include "test/support/scratch.hpp"
#include "test/support/shell.hpp"
#include "test/support/timing.hpp"
#include "test/support/virtual_dive.hpp"

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

TEST_CASE("fathom: a bad command line is one line and exit code 2") {
  one_line(shell(kOfflineTool + " diagnose --trian x"), 2, "--help");
  one_line(shell(kOfflineTool), 2, "subcommand");
  one_line(shell(kOfflineTool + " nonsense"), 2, "nonsense is no command");
  one_line(shell(kOfflineTool + " diganose"), 2, "diganose is no command, but diagnose is");
  one_line(shell(kOfflineTool + " diag"), 2, "diag is no command, but diagnose is");
  CHECK(shell(kOfflineTool + " --help").code == 0);
  CHECK(shell(kOfflineTool + " diagnose --help").says("--validate"));
}

TEST_CASE("fathom: a wrong unit in the vehicle file names the line and both units") {
  const Scratch scratch;
  std::string text = kSledFile;
  text.replace(text.find("20 kg"), 5, "20 N");
  test::write_bytes(scratch.path("v.yaml"), text);
  test::write_bytes(scratch.path("a.csv"), "");
  one_line(shell(kOfflineTool + " diagnose --vehicle " + scratch.path("v.yaml") + " --train " + scratch.path("a.csv") +
                 " --out " + scratch.path("out")),
           1, "v.yaml:4");
}

TEST_CASE("fathom: a missing column, a word among numbers, a missing file") {
  const Scratch scratch;
  const std::string header = "t,x,y,z,u,v,w,X,Y,Z,K,M,N";
  test::write_bytes(scratch.path("a.csv"), table("t,x,y,q,u,v,w,X,Y,Z,K,M,N"));
  one_line(shell(kOfflineTool + " import " + scratch.path("a.csv") + " --out " + scratch.path("a.lcmlog")), 1, "a.csv");
  CHECK_FALSE(std::filesystem::exists(scratch.path("a.lcmlog")));
  test::write_bytes(scratch.path("b.csv"), table(header, "fast"));
  one_line(shell(kOfflineTool + " import " + scratch.path("b.csv") + " --out " + scratch.path("b.lcmlog")), 1,
           "b.csv:9");
  one_line(shell(kOfflineTool + " import " + scratch.path("c.csv") + " --out " + scratch.path("c.lcmlog")), 1, "c.csv");
  one_line(shell(kOfflineTool + " import " + test::file("test/data/beluga/yaw-1.csv") + " --map " +
                 scratch.path("no.yaml") + " --out " + scratch.path("d.lcmlog")),
           1, "no.yaml");
}

TEST_CASE("fathom: runs of one name in two folders are two, one file twice is refused, a name may end in capitals") {
  const Scratch scratch;
  test::write_bytes(scratch.path("v.yaml"), kSledFile);
  for (const char* day : {"day1", "day2"}) {
    std::filesystem::create_directories(scratch.path(day));
    test::write_bytes(scratch.path(std::string(day) + "/run.CSV"), table("t,x,y,z,u,v,w,X,Y,Z,K,M,N"));
  }
  const std::string check = kOfflineTool + " check --vehicle " + scratch.path("v.yaml") + " ";
  const std::string first = scratch.path("day1/run.CSV"), second = scratch.path("day2/run.CSV");
  const Ran both = shell(check + first + " " + second);
  CAPTURE(both.text);
  CHECK(both.code == 0);
  one_line(shell(check + first + " " + second + " " + first), 1, "run.CSV: this is ");
}

TEST_CASE("fathom: vehicle files to begin with are listed, printed as they are, and a slip of the name is told") {
  const Ran listed = shell(kOfflineTool + " vehicle");
  CHECK(listed.code == 0);
  for (const char* name : {"bluerov2_heavy", "blueboat", "otter", "remus100", "slocum", "cybership2", "kvlcc2_l3"})
    CHECK(listed.says(name));
  const Ran otter = shell(kOfflineTool + " vehicle otter");
  CHECK(otter.code == 0);
  CHECK(otter.text == test::read_bytes(FATHOM_SOURCE_DIR "/config/vehicles/otter.yaml"));
  one_line(shell(kOfflineTool + " vehicle remus_100"), 1, "did you mean remus100?");
}

TEST_CASE(
    "fathom: a map's commands are of the kinds that the vehicle's actuators take, or refused with what they are") {
  const Scratch scratch;
  test::write_bytes(scratch.path("v.yaml"), test::read_bytes(FATHOM_SOURCE_DIR "/config/vehicles/slocum.yaml"));
  test::write_bytes(scratch.path("a.csv"), "t,a,b\n0,100,0.5\n1,110,0.6\n");
  const auto import = [&](const std::string& units) {
    test::write_bytes(scratch.path("map.yaml"),
                      "source: s\nlicence: l\ntime: {column: t, unit: s}\nthrusters: {inputs: "
                      "{columns: [a, b], units: [" +
                          units + "]}}\n");
    return shell(kOfflineTool + " import --vehicle " + scratch.path("v.yaml") + " --map " + scratch.path("map.yaml") +
                 " --out " + scratch.path("a.lcmlog") + " " + scratch.path("a.csv"));
  };
  CHECK(import("cc, in").code == 0);
  const Ran swapped = import("in, cc");
  CHECK(swapped.code == 1);
  CHECK(swapped.says("map.yaml:4: 'inputs' names 2 commands whose units are not those of the vehicle's actuators"));
  CHECK(swapped.says("engine in m^3, battery in m (or another"));
}

TEST_CASE("fathom: folds need recordings to hold out, and hold them out themselves") {
  const Scratch scratch;
  test::write_bytes(scratch.path("v.yaml"), kSledFile);
  test::write_bytes(scratch.path("a.csv"), table("t,x,y,z,phi,theta,psi,u,v,w,p,q,r"));
  const std::string command = kOfflineTool + " diagnose --vehicle " + scratch.path("v.yaml") + " --train " +
                              scratch.path("a.csv") + " --out " + scratch.path("d");
  one_line(shell(command + " --folds 3"), 1, "--folds: at least two recordings are needed, 1 is given");
  one_line(shell(command + " --folds 3 --validate " + scratch.path("a.csv")), 1, "and no --validate");
}

TEST_CASE("fathom: import, then diagnose, leaves a result with every key and a page") {
  const Scratch scratch;
  test::write_bytes(scratch.path("v.yaml"), kSledFile);
  const model::Vehicle vehicle = model::Vehicle::load(scratch.path("v.yaml"));
  for (unsigned seed = 1; seed <= 2; ++seed) {
    const std::string name = "run" + std::to_string(seed);
    const auto dive = test::make_dive(vehicle, {.duration = 40.0, .seed = seed, .spread = 0.0, .wrench = true});
    tables::write_file(scratch.path(name + ".csv"), tables::to_csv(dive.trial));
    const Ran ran =
        shell(kOfflineTool + " import " + scratch.path(name + ".csv") + " --out " + scratch.path(name + ".lcmlog"));
    REQUIRE_MESSAGE(ran.code == 0, ran.text);
  }
  const std::string common = kOfflineTool + " diagnose --vehicle " + scratch.path("v.yaml") + " --train ";
  const Ran ran = shell(common + scratch.path("run1.lcmlog") + " --validate " + scratch.path("run2.csv") + " --out " +
                        scratch.path("out"));
  REQUIRE_MESSAGE(ran.code == 0, ran.text);
  CHECK(ran.says("Verdict"));
  CHECK(ran.says("report.html"));
  const auto result = nlohmann::json::parse(test::read_bytes(scratch.path("out/result.json")));
  CHECK(result.at("schema") == 2);
  CHECK(result.at("vehicle") == "Sled");
  CHECK(result.at("train").at(0) == "run1");
  CHECK(result.at("validate").at(0) == "run2");
  for (const char* key : {"consistency", "verdict", "effects", "candidates"}) CHECK(result.contains(key));
  for (const char* when : {"before", "after"}) {
    CHECK(result.at("error").at(when).at("force_rmse").contains("X"));
    CHECK(result.at("error").at(when).at("prediction").size() == 3);
    CHECK(result.at("parameters").at(when).at("m_X").contains("std"));
    CHECK(result.at("residual").at(when).contains("N"));
  }
  CHECK(result.at("error").at("improvement").contains("ci95"));
  CHECK(test::read_bytes(scratch.path("out/report.html")).size() > 10'000);
  CHECK(test::against_schema(scratch, scratch.path("out/result.json"), "diagnosis-2") == "");
  CHECK_FALSE(result.at("causes").empty());
  CHECK(result.at("command") == "fathom diagnose --vehicle " + scratch.path("v.yaml") + " --train " +
                                    scratch.path("run1.lcmlog") + " --validate " + scratch.path("run2.csv"));
  REQUIRE(result.at("files").size() == 3);
  CHECK(shell("sha256sum " + scratch.path("run1.lcmlog"))
            .text.starts_with(result.at("files").at(1).at("sha256").get<std::string>()));
  const auto& covariance = result.at("covariance");
  const auto& rows = covariance.at("matrix");
  REQUIRE(rows.size() == covariance.at("names").size());
  REQUIRE(rows.size() > 3);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    CHECK(rows[i][i].get<double>() > 0.0);
    for (std::size_t j = 0; j < i; ++j) CHECK(rows[i][j].get<double>() == doctest::Approx(rows[j][i].get<double>()));
  }

  const Ran held = shell(common + scratch.path("run1.lcmlog") + " --out " + scratch.path("held"));
  REQUIRE_MESSAGE(held.code == 0, held.text);
  CHECK(held.says("last 30 %"));
  const auto other = nlohmann::json::parse(test::read_bytes(scratch.path("held/result.json")));
  CHECK(other.at("validate").at(0) == "run1 (last 30 %)");

  const Ran likely = shell(common + scratch.path("run1.lcmlog") + " --validate " + scratch.path("run2.csv") +
                           " --without current cross_coupling --out " + scratch.path("likely"));
  REQUIRE_MESSAGE(likely.code == 0, likely.text);
  const auto third = nlohmann::json::parse(test::read_bytes(scratch.path("likely/result.json")));
  CHECK(third.at("verdict") == "adequate");
  CHECK(third.at("causes").at(0).at("cause") == "nothing_found");
  std::map<std::string, std::string> reasons;
  for (const auto& candidate : third.at("candidates")) reasons[candidate.at("name")] = candidate.at("reason");
  CHECK(reasons["current"] == "taken out of the list");
  CHECK(reasons["cross_coupling"] == "taken out of the list");
}

TEST_CASE("fathom: an effect to be taken out must be listed") {
  const Scratch scratch;
  test::write_bytes(scratch.path("v.yaml"), kSledFile);
  const std::string common = kOfflineTool + " diagnose --vehicle " + scratch.path("v.yaml") + " --train a.csv --out " +
                             scratch.path("out") + " --without ";
  one_line(shell(common + "curent"), 1, "no effect has this name; listed are");
}

TEST_CASE("fathom: a diagnosis that is refused leaves no folder behind, and takes none away") {
  const Scratch scratch;
  test::write_bytes(scratch.path("v.yaml"), kSledFile);
  const std::string common = kOfflineTool + " diagnose --vehicle " + scratch.path("v.yaml") + " --train " +
                             scratch.path("missing.csv") + " --out ";
  CHECK(shell(common + scratch.path("new/deep/out")).code == 1);
  CHECK_FALSE(std::filesystem::exists(scratch.path("new")));
  std::filesystem::create_directories(scratch.path("old/empty"));
  CHECK(shell(common + scratch.path("old/empty/")).code == 1);
  CHECK(shell(common + scratch.path("old/out/")).code == 1);
  CHECK(std::filesystem::exists(scratch.path("old/empty")));
  CHECK_FALSE(std::filesystem::exists(scratch.path("old/out")));
  one_line(shell(common + scratch.path("v.yaml/out")), 1, "cannot make this folder");
}

TEST_CASE("fathom: what begins in the last 30 % of a run is fitted too, and other parts judge") {
  if (!test::kTimed) return;
  const Scratch scratch;
  test::write_bytes(scratch.path("v.yaml"), kSledFile);
  const model::Vehicle vehicle = model::Vehicle::load(scratch.path("v.yaml"));
  const std::string common = kOfflineTool + " diagnose --vehicle " + scratch.path("v.yaml") + " --train ";
  const auto diagnosed = [&](double onset) {
    auto dive = test::make_dive(vehicle, {.duration = 200.0,
                                          .seed = 7,
                                          .wrench = true,
                                          .effects = {test::active("payload_change", {30.0, 0.0, onset})}});
    std::mt19937 random{7};
    std::normal_distribution<double> normal;
    for (std::size_t k = 0; k < dive.trial.size(); ++k) {  // motion capture: 2 mm and 2 mrad
      for (double& along : dive.trial.p_WB[k].reshaped()) along += 2e-3 * normal(random);
      dive.trial.q_WB[k] = dive.trial.q_WB[k] * Eigen::AngleAxisd{2e-3 * normal(random), Eigen::Vector3d::UnitZ()};
    }
    tables::write_file(scratch.path("run.csv"), tables::to_csv(dive.trial));
    const Ran ran = shell(common + scratch.path("run.csv") + " --out " + scratch.path("out"));
    REQUIRE_MESSAGE(ran.code == 0, ran.text);
    return std::pair{ran, nlohmann::json::parse(test::read_bytes(scratch.path("out/result.json")))};
  };
  for (const auto& [onset, judging] : {std::pair{150.0, "run (first 15 %)"}, {175.0, "run (first 30 %)"}}) {
    CAPTURE(onset);
    const auto [ran, result] = diagnosed(onset);
    CHECK(ran.says("note: something begins near 1"));
    CHECK(result.at("validate").at(0) == judging);
    REQUIRE_FALSE(result.at("effects").empty());
    CHECK(result.at("effects").at(0).at("name") == "payload_change");
    const double found = result.at("effects").at(0).at("parameters").at("onset").at("value");
    CHECK(found == doctest::Approx(onset).epsilon(0.01));
  }
  CHECK(diagnosed(100.0).second.at("validate").at(0) == "run (last 30 %)");  // nothing begins there
}

TEST_CASE("fathom: which file is named first changes nothing") {
  const Scratch scratch;
  test::write_bytes(scratch.path("v.yaml"), kSledFile);
  const model::Vehicle vehicle = model::Vehicle::load(scratch.path("v.yaml"));
  std::vector<std::string> runs;
  for (unsigned seed = 3; seed <= 5; ++seed) {
    const auto dive = test::make_dive(vehicle, {.duration = 20.0 + seed, .seed = seed, .wrench = true});
    runs.push_back(scratch.path("run" + std::to_string(seed) + ".csv"));
    tables::write_file(runs.back(), tables::to_csv(dive.trial));
  }
  std::string first;
  for (const auto& [a, b, c] : {std::array{0, 1, 2}, std::array{2, 0, 1}}) {
    const Ran ran = shell(kOfflineTool + " diagnose --vehicle " + scratch.path("v.yaml") + " --train " + runs[a] + " " +
                          runs[b] + " " + runs[c] + " --out " + scratch.path("out"));
    REQUIRE_MESSAGE(ran.code == 0, ran.text);
    const std::string result = test::read_bytes(scratch.path("out/result.json"));
    if (first.empty()) first = result;
    CHECK(result == first);
  }
}

TEST_CASE("fathom: gaps of whole rows are left out and told of; where they leave nothing, one line says so") {
  const Scratch scratch;
  test::write_bytes(scratch.path("v.yaml"), kSledFile);
  const model::Vehicle vehicle = model::Vehicle::load(scratch.path("v.yaml"));
  const auto dive = test::make_dive(vehicle, {.duration = 60.0, .seed = 6, .wrench = true});
  const std::string whole = tables::to_csv(dive.trial);
  const auto torn = [&](auto lost) {
    std::istringstream lines(whole);
    std::string text;
    for (std::string line; std::getline(lines, line);) {
      if (line.starts_with("t,") || !lost(std::stod(line))) text += line + "\n";
    }
    return text;
  };
  test::write_bytes(scratch.path("some.csv"), torn([](double t) { return t > 20.0 && t < 28.0; }));
  test::write_bytes(scratch.path("many.csv"), torn([](double t) { return std::fmod(t, 8.0) > 6.0; }));
  const std::string common =
      kOfflineTool + " diagnose --vehicle " + scratch.path("v.yaml") + " --out " + scratch.path("out") + " --train ";
  const Ran some = shell(common + scratch.path("some.csv"));
  REQUIRE_MESSAGE(some.code == 0, some.text);
  const auto result = nlohmann::json::parse(test::read_bytes(scratch.path("out/result.json")));
  CHECK(result.at("train").size() == 1);
  bool told = false;
  for (const auto& finding : result.at("consistency"))
    told = told || (finding.at("signal") == "thrusters" && finding.at("finding") == "gap");
  CHECK(told);
  CHECK(some.says("of the recordings was left out"));
  const Ran many = shell(common + scratch.path("many.csv"));
  CAPTURE(many.text);
  CHECK(many.code == 1);
  CHECK(many.says("many.csv: what drove the vehicle is missing for 10 s of 42.1 s"));
  CHECK(many.lines() == 1);  // nothing had been estimated yet
}

}  // namespace fathom
