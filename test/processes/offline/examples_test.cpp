// Every command's --help ends with an example, and every example runs: what works on the files of this test works, what
// needs a bus or other files is at least a command line that is understood.
#include <doctest/doctest.h>

#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "common/report/json.hpp"
#include "common/tables/writer.hpp"
#include "test/support/diagnosis_fixture.hpp"
#include "test/support/scratch.hpp"
#include "test/support/shell.hpp"
#include "test/support/timing.hpp"
#include "test/support/virtual_dive.hpp"

namespace fathom {
namespace {

using test::Ran;
using test::shell;

const std::string kTool = test::program("fathom");
constexpr const char* kBus = "LCM_DEFAULT_URL='udpm://239.255.76.151:7651?ttl=0'";  // nobody else's
constexpr int kBadLine = 2;                                    // exit code of a command line that is not understood
const std::set<std::string> kForwarded{"track", "calibrate"};  // another program's commands, with its own --help
const std::set<std::string> kComplete{"vehicle", "import", "check", "explain", "diff", "info", "export", "emulate"};

std::vector<std::string> commands() {
  std::vector<std::string> names;
  bool listed = false;
  std::istringstream lines{shell(kTool + " --help").text};
  for (std::string line; std::getline(lines, line);) {
    if (listed && line.starts_with("  ") && line.size() > 2 && line[2] != ' ')
      names.push_back(line.substr(2, line.find(' ', 2) - 2));
    listed = listed || line.starts_with("Subcommands:");
  }
  return names;
}

std::string last_line(const std::string& text) {
  std::string last;
  std::istringstream lines{text};
  for (std::string line; std::getline(lines, line);) {
    if (!line.empty()) last = line;
  }
  return last;
}

/// What the examples name.
void prepare(const test::Scratch& scratch) {
  test::write_bytes(
      scratch.path("V.yaml"),
      "name: Sled\ndof: [surge, sway, heave, roll, pitch, yaw]\nmass: 12 kg\nwater_density: 1000 kg/m^3\n");
  const model::Vehicle vehicle = model::Vehicle::load(scratch.path("V.yaml"));
  const auto dive = test::make_dive(vehicle, {.duration = 15.0, .seed = 1, .wrench = true});
  tables::write_file(scratch.path("DIVE.csv"), tables::to_csv(dive.trial));
  const auto result = test::made_up_report({.samples = 0}).result;
  for (const char* folder : {"BEFORE", "AFTER"}) {
    std::filesystem::create_directory(scratch.path(folder));
    test::write_bytes(scratch.path(std::string{folder} + "/result.json"), report::to_json(result));
  }
  test::write_bytes(scratch.path("S.yaml"), "name: nowhere\n");
  REQUIRE(shell("cd '" + scratch.path("") + "' && " + kTool + " import DIVE.csv --out RUN.lcmlog").code == 0);
}

}  // namespace

TEST_CASE("fathom: every --help ends with an example, and it runs") {
  const test::Scratch scratch;
  prepare(scratch);
  const std::vector<std::string> names = commands();
  REQUIRE(names.size() > 20);
  std::size_t complete = 0;
  for (const std::string& name : names) {
    if (kForwarded.contains(name)) continue;
    CAPTURE(name);
    const std::string example = last_line(shell(kTool + " " + name + " --help").text);
    const std::string begin = "Example: fathom ";
    REQUIRE(example.starts_with(begin + name));
    const std::string limit = test::limit(kComplete.contains(name) ? 60 : 2);
    const Ran ran =
        shell("cd '" + scratch.path("") + "' && " + kBus + " " + limit + kTool + " " + example.substr(begin.size()));
    CAPTURE(example);
    CAPTURE(ran.text);
    CHECK(ran.code != kBadLine);
    CHECK(ran.code < 126);  // was found, and did not crash
    if (!kComplete.contains(name)) continue;
    CHECK(ran.code == 0);
    ++complete;
  }
  CHECK(complete == kComplete.size());
}

}  // namespace fathom
