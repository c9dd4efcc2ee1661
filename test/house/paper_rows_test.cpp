// docs/paper_rows.md keeps its promises: every row of both papers stands there once, and every file that it names is
// there.
#include <doctest/doctest.h>

#include <filesystem>
#include <fstream>
#include <map>
#include <regex>
#include <set>
#include <string>
#include <vector>

namespace {

namespace fs = std::filesystem;
const fs::path kRoot = FATHOM_SOURCE_DIR;

std::vector<std::string> lines_of(const fs::path& path) {
  std::vector<std::string> lines;
  std::ifstream file{path};
  for (std::string line; std::getline(file, line);) lines.push_back(line);
  return lines;
}

/// Rows as the first cells of both tables number them: "006, 008 to 011" of the first, "P-009, P-011" of the second.
std::map<char, std::multiset<int>> rows() {
  std::map<char, std::multiset<int>> found;
  const std::regex cell{R"(^\| ([KPX0-9 ,to-]*\d{2,3}[KPX0-9 ,to-]*) \|)"};
  const std::regex one{R"(([KPX])?-?(\d{2,3})(?: to (?:[KPX]-)?(\d{2,3}))?)"};
  for (const std::string& line : lines_of(kRoot / "docs/paper_rows.md")) {
    std::smatch first;
    if (!std::regex_search(line, first, cell)) continue;
    const std::string text = first[1];
    for (auto it = std::sregex_iterator(text.begin(), text.end(), one); it != std::sregex_iterator(); ++it) {
      const char paper = (*it)[1].matched ? (*it)[1].str().front() : 'K';
      const int begin = std::stoi((*it)[2]), end = (*it)[3].matched ? std::stoi((*it)[3]) : begin;
      for (int i = begin; i <= end; ++i) found[paper].insert(i);
    }
  }
  return found;
}

/// A path that the page names in code: from the root, or as the page's head says from test/common; names of files alone
/// may stand anywhere.
bool exists(const std::string& path) {
  if (path.find('/') == std::string::npos) {
    for (const char* top : {"common", "test", "config", "docs", "processes"}) {
      for (const auto& entry : fs::recursive_directory_iterator{kRoot / top}) {
        if (entry.path().filename() == path) return true;
      }
    }
    return false;
  }
  return fs::exists(kRoot / path) || fs::exists(kRoot / "test/common" / path);
}

}  // namespace

TEST_CASE("paper rows: every row of both papers has its place") {
  const auto found = rows();
  const auto check = [&](char paper, int first, int last) {
    for (int i = first; i <= last; ++i) {
      CAPTURE(paper);
      CAPTURE(i);
      CHECK(found.at(paper).contains(i));
    }
  };
  check('K', 1, 70);
  check('K', 100, 111);
  check('K', 200, 212);
  check('P', 1, 35);
  check('X', 1, 5);
  for (const int i : found.at('P')) CHECK(found.at('P').count(i) == 1);
}

TEST_CASE("paper rows: every file that is named is there") {
  const std::regex file{R"(`([A-Za-z0-9_./-]+\.(?:cpp|hpp|md|yaml|svg|py))`)"};
  int named = 0;
  for (const std::string& line : lines_of(kRoot / "docs/paper_rows.md")) {
    for (auto it = std::sregex_iterator(line.begin(), line.end(), file); it != std::sregex_iterator(); ++it) {
      ++named;
      CHECK_MESSAGE(exists((*it)[1]), (*it)[1].str());
    }
  }
  CHECK(named > 60);
}
