// The lists of packages agree: what is built with is there for arm64, too.
#include <doctest/doctest.h>

#include <fstream>
#include <set>
#include <string>

namespace fathom {
namespace {

/// The packages of a list in scripts/, without comments.
std::set<std::string> list(const std::string& name) {
  std::ifstream file{std::string{FATHOM_SOURCE_DIR} + "/scripts/" + name};
  std::set<std::string> packages;
  for (std::string line; std::getline(file, line);) {
    line = line.substr(0, line.find('#'));
    if (!line.empty()) packages.insert(line);
  }
  return packages;
}

}  // namespace

TEST_CASE("packages: every library of the build is in the list for arm64") {
  const std::set<std::string> native = list("packages.txt"), arm64 = list("packages-arm64.txt");
  REQUIRE(native.size() > 20);
  for (const std::string& each : native) {
    if (!each.ends_with("-dev")) continue;
    CAPTURE(each);
    CHECK(
        (arm64.contains(each + ":arm64") || arm64.contains(each)));  // the latter: headers alone, of all architectures
  }
}

}  // namespace fathom
