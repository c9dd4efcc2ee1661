// Every program tells its version and writes pages about itself, as the package's build asks it to.
#include "common/base/version.hpp"

#include <doctest/doctest.h>

#include <filesystem>
#include <fstream>
#include <set>
#include <string>

#include "test/support/scratch.hpp"
#include "test/support/shell.hpp"

namespace fathom {

TEST_CASE("programs: each has --version, a manual page that names it, and completion") {
  const std::string bin = std::string{FATHOM_BINARY_DIR} + "/bin/";
  std::set<std::string> programs{"fathom"};  // and those that are installed under another name, by that name
  for (const auto& entry : std::filesystem::directory_iterator{bin}) {
    const std::string name = entry.path().filename().string();
    if (name.starts_with("fathom-")) programs.insert(name);
  }
  REQUIRE(programs.size() >= 20);
  const test::Scratch scratch;
  for (const std::string& name : programs) {
    CAPTURE(name);
    const auto said = test::shell("'" + bin + name + "' --version");
    CHECK(said.code == 0);
    CHECK(said.text.ends_with(" " + std::string{version()} + "\n"));
    CHECK(test::shell("'" + bin + name + "' --pages '" + scratch.path("pages") + "' " + name).code == 0);
    std::ifstream page{scratch.path("pages/" + name + ".1")};
    std::string line;
    std::getline(page, line);
    CHECK(line.starts_with(".TH \""));
    CHECK(std::filesystem::exists(scratch.path("pages/" + name + ".completion")));
  }
  for (const char* command : {"diagnose", "track", "calibrate", "doctor"})
    CHECK(std::filesystem::exists(scratch.path(std::string{"pages/fathom-"} + command + ".1")));
}

}  // namespace fathom
