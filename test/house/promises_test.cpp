// The table of promises in docs/operations.md: every row names a test, and every test that it names exists.
#include <doctest/doctest.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <regex>
#include <set>
#include <string>
#include <vector>

namespace fathom {
namespace {

namespace fs = std::filesystem;

std::string content(const fs::path& path) {
  std::ifstream file{path};
  return {std::istreambuf_iterator<char>{file}, {}};
}

/// Names of TEST_CASEs, string literals that stand one behind the other joined.
std::set<std::string> cases() {
  static const std::regex kCase{R"~(TEST_CASE\(\s*((?:"(?:[^"\\]|\\.)*"\s*)+))~"};
  static const std::regex kPart{R"~("((?:[^"\\]|\\.)*)")~"};
  std::set<std::string> all;
  for (const auto& entry : fs::recursive_directory_iterator{std::string{FATHOM_SOURCE_DIR} + "/test"}) {
    if (entry.path().extension() != ".cpp") continue;
    const std::string text = content(entry.path());
    for (std::sregex_iterator each{text.begin(), text.end(), kCase}, end; each != end; ++each) {
      const std::string literals = (*each)[1];
      std::string name;
      for (std::sregex_iterator part{literals.begin(), literals.end(), kPart}; part != end; ++part) name += (*part)[1];
      all.insert(name);
    }
  }
  return all;
}

/// The last cell of each row of the table, as the names between back quotes.
std::vector<std::vector<std::string>> promises() {
  const std::string page = content(std::string{FATHOM_SOURCE_DIR} + "/docs/operations.md");
  const auto begin = page.find("## Every promise"), end = page.find("### What Fathom does not protect against");
  REQUIRE(begin != std::string::npos);
  REQUIRE(end != std::string::npos);
  static const std::regex kRow{R"(\n\|([^\n]*)\|(?=\n))"}, kName{"`([^`]+)`"};
  const std::string table = page.substr(begin, end - begin);
  std::vector<std::vector<std::string>> rows;
  for (std::sregex_iterator each{table.begin(), table.end(), kRow}, last; each != last; ++each) {
    const std::string row = (*each)[1];
    const std::string cell = row.substr(row.rfind('|') + 1);
    std::vector<std::string> names;
    for (std::sregex_iterator name{cell.begin(), cell.end(), kName}; name != last; ++name) names.push_back((*name)[1]);
    rows.push_back(std::move(names));
  }
  return rows;
}

}  // namespace

TEST_CASE("promises: every row of the table in docs/operations.md names tests, and they are there") {
  const std::set<std::string> there = cases();
  CHECK(there.size() > 1000);
  CHECK(there.contains("promises: every row of the table in docs/operations.md names tests, and they are there"));
  const auto rows = promises();
  REQUIRE(rows.size() > 15);
  for (std::size_t i = 2; i < rows.size(); ++i) {  // behind the heading and its line
    CAPTURE(i);
    CHECK_FALSE(rows[i].empty());
    for (const std::string& name : rows[i]) CHECK_MESSAGE(there.contains(name), name);
  }
}

}  // namespace fathom
