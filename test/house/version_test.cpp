// The version that a build states: of a tag, behind a tag, without tag, without git (cmake/version.cmake).
#include <doctest/doctest.h>

#include <chrono>
#include <filesystem>
#include <fstream>
#include <regex>
#include <string>

#include "test/support/scratch.hpp"
#include "test/support/shell.hpp"

namespace fathom {
namespace {

namespace fs = std::filesystem;

class Tree {
 public:
  Tree() {
    fs::create_directories(root_ / "cmake");
    for (const char* each : {"version.cmake", "version.cpp.in"})
      fs::copy_file(fs::path{FATHOM_SOURCE_DIR} / "cmake" / each, root_ / "cmake" / each);
  }

  void git(const std::string& words) const {
    const auto ran = test::shell("git -C '" + root_.string() +
                                 "' -c user.name=n -c user.email=e@x -c init.defaultBranch=m " + words);
    REQUIRE_MESSAGE(ran.code == 0, ran.text);
  }
  void commit() const {
    git("add .");
    git("commit -q --allow-empty -m one");
  }
  void edit() const { std::ofstream{root_ / "cmake" / "version.cpp.in", std::ios::app} << "// more\n"; }
  [[nodiscard]] fs::path root() const { return root_; }
  [[nodiscard]] std::string version(const std::string& stated = "") const {
    const auto ran = test::shell("cmake '-DSOURCE=" + root_.string() + "' -DPROJECT=0.3.0 '-DSTATED=" + stated +
                                 "' '-DFOLDER=" + (root_ / "out").string() + "' -P '" +
                                 (root_ / "cmake/version.cmake").string() + "'");
    REQUIRE_MESSAGE(ran.code == 0, ran.text);
    std::ifstream file{root_ / "out" / "version.txt"};
    std::string line;
    std::getline(file, line);
    return line;
  }

 private:
  test::Scratch scratch_;
  fs::path root_{scratch_.path("tree")};
};

bool matches(const std::string& text, const std::string& pattern) {
  return std::regex_match(text, std::regex{pattern});
}

}  // namespace

TEST_CASE("version: the project's without git, a tag's at the tag, the commit's behind it") {
  const Tree tree;
  CHECK(tree.version() == "0.3.0");  // an archive
  tree.git("init -q");
  CHECK(tree.version() == "0.3.0~unknown");  // git has no answer: no release
  tree.commit();
  CHECK(matches(tree.version(), R"(0\.3\.0~git\d{12}\.[0-9a-f]{7,})"));
  tree.edit();
  CHECK(matches(tree.version(), R"(0\.3\.0~git\d{12}\.[0-9a-f]{7,}\.modified)"));
  tree.commit();
  tree.git("tag v0.3.0");
  CHECK(tree.version() == "0.3.0");
  tree.edit();
  CHECK(tree.version() == "0.3.0+modified");
  tree.commit();
  CHECK(matches(tree.version(), R"(0\.3\.0\+git\d{12}\.[0-9a-f]{7,})"));
  CHECK(tree.version("1.2-arm") == "1.2-arm");  // a distributor's
}

TEST_CASE("version: a build that finds the same version writes nothing, so that nothing is compiled") {
  const Tree tree;
  CHECK(tree.version() == "0.3.0");
  const auto written = tree.root() / "out" / "version.cpp";
  const auto old = fs::last_write_time(written) - std::chrono::hours{1};
  fs::last_write_time(written, old);
  CHECK(tree.version() == "0.3.0");
  CHECK(fs::last_write_time(written) == old);
  CHECK(tree.version("0.4.0") == "0.4.0");
  CHECK(fs::last_write_time(written) != old);
}

}  // namespace fathom
