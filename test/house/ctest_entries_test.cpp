// Every doctest case is an entry of ctest: no name is mangled on the way, and an entry that runs nothing fails.
#include <doctest/doctest.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "test/support/ctest_names.hpp"
#include "test/support/scratch.hpp"
#include "test/support/shell.hpp"

namespace fathom {
namespace {

using test::shell;

// All that CMake, ctest, doctest's filters or a shell could take for their own.
constexpr const char* kAwkward = R"x(ctest: a, b; "c" 'd' \e\, *f* [g [[h]=] ${i} $j @k@ #l (m) %n% ?o? <p> &q| !)x";

/// This executable as a shell's words; behind an emulator, if it was compiled for another processor.
std::string self() {
  const std::string path = "'" + std::filesystem::read_symlink("/proc/self/exe").string() + "'",
                    emulator = FATHOM_EMULATOR;
  return emulator.empty() ? path : "'" + emulator + "' " + path;
}

/// What ctest reads of this executable, in a folder of its own: the build's may be in use.
nlohmann::json entries() {
  const test::Scratch scratch;
  std::ofstream{scratch.path("CTestTestfile.cmake")} << "include([==[" << FATHOM_BINARY_DIR
                                                     << "/test/test_house_entries.cmake]==])\n";
  const auto ran = shell("ctest --test-dir '" + scratch.path("") + "' --show-only=json-v1");
  REQUIRE_MESSAGE(ran.code == 0, ran.text);
  return nlohmann::json::parse(ran.text.substr(ran.text.find('{')))["tests"];
}

}  // namespace

TEST_CASE(R"x(ctest: a, b; "c" 'd' \e\, *f* [g [[h]=] ${i} $j @k@ #l (m) %n% ?o? <p> &q| !)x") {
  // That it runs as an entry of its own is what is tried: main() fails when the name meets no case, or more than one.
  bool found = false;
  for (const auto& entry : entries()) {
    if (entry["name"] != "house: " + std::string{kAwkward}) continue;
    found = true;
    const auto command = entry["command"].get<std::vector<std::string>>();
    REQUIRE(command.size() >= 3);  // before it an emulator, if it was compiled for another processor
    CHECK(command[command.size() - 2] == "--exactly");
    CHECK(command.back() == kAwkward);
  }
  CHECK(found);
}

TEST_CASE("ctest: a name that begins like another's runs alone") {
  CHECK(shell(self() + " --exactly 'ctest: a name that begins like another'").code == 1);
  CHECK(shell(self() + " --exactly 'CTEST: a literal of CMake ends where its text does'").code == 1);
  const auto ran = shell(self() + " --exactly 'ctest: a literal of CMake ends where its text does'");
  CHECK(ran.code == 0);
  CHECK_MESSAGE(ran.says("test cases: 1 | 1 passed"), ran.text);
}

TEST_CASE("ctest: a run in which no case takes part fails") {
  const auto ran = shell(self() + " --test-case=nothing-has-this-name");
  CHECK(ran.code == 1);
  CHECK_MESSAGE(ran.says("0 test cases are meant"), ran.text);
  CHECK(shell(self() + " --count").code == 0);
}

TEST_CASE("ctest: a list that cannot be written fails the build") {
  CHECK(shell(self() + " --list-for-ctest /nowhere/list").code == 1);
}

TEST_CASE("ctest: as many entries as the executables have cases") {
  // Of this executable; each lists its own in the same way.
  const auto counted = shell(self() + " --list-test-cases --no-intro");
  std::set<std::string> names;
  std::istringstream lines{counted.text};
  for (std::string line; std::getline(lines, line);) {
    if (!line.starts_with("[doctest]") && line.find("====") != 0) names.insert("house: " + line);
  }
  CHECK(names.size() >= 10);
  std::set<std::string> listed;
  for (const auto& entry : entries()) {
    listed.insert(entry["name"].get<std::string>());
    bool labelled = false, limited = false;
    for (const auto& property : entry["properties"]) {
      labelled = labelled || (property["name"] == "LABELS" && property["value"].size() == 1);
      limited = limited || property["name"] == "TIMEOUT";
    }
    CHECK_MESSAGE((labelled && limited), entry["name"]);
  }
  CHECK(listed == names);
}

TEST_CASE("ctest: a literal of CMake ends where its text does") {
  CHECK(test::cmake_literal("plain") == "[[plain]]");
  CHECK(test::cmake_literal("") == "[[]]");
  CHECK(test::cmake_literal("a]") == "[=[a]]=]");
  CHECK(test::cmake_literal("a]]b") == "[=[a]]b]=]");
  CHECK(test::cmake_literal("a]]b]=") == "[==[a]]b]=]==]");
}

TEST_CASE("ctest: a filter keeps its commas and backslashes") {
  CHECK(test::doctest_filter("a, b") == "a\\, b");
  CHECK(test::doctest_filter("a\\b") == "a\\\\b");
  CHECK(test::doctest_filter("P* [m]?") == "P* [m]?");
}

}  // namespace fathom
