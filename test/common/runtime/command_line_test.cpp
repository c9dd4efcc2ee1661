// What is wrong with an option is one line that a person can read.
#include "common/runtime/command_line.hpp"

#include <doctest/doctest.h>

#include <string>

#include "common/base/error.hpp"

namespace fathom::runtime {
namespace {

struct Tank {
  CommandLine app{"Fills tanks.", "tank"};
  double depth{1.0}, share{0.5}, rest{};
  int tags{1};

  Tank() {
    app.add_option("--depth", depth, "m")->positive();
    app.add_option("--rest", rest, "s")->not_negative();
    app.add_option("--share", share, "of it")->within(1e-12, 1.0);
    app.add_option("--tags", tags, "on the floor")->positive();
  }
};

/// What is said of these words; empty: they are taken.
std::string said(const char* option, const char* value) {
  Tank tank;
  const char* const words[] = {"tank", option, value};
  try {
    return tank.app.parse(3, words) ? "" : "only asked";
  } catch (const UsageError& error) {
    return error.what();
  }
}

}  // namespace

TEST_CASE("command line: a number out of its bounds is told with them, and short") {
  CHECK(said("--depth", "0") == "--depth: must be more than 0, not 0; see tank --help");
  CHECK(said("--depth", "-3") == "--depth: must be more than 0, not -3; see tank --help");
  CHECK(said("--rest", "-0.1") == "--rest: must not be negative, not -0.1; see tank --help");
  CHECK(said("--share", "0") == "--share: must lie from 1e-12 to 1, not 0; see tank --help");
  CHECK(said("--share", "2") == "--share: must lie from 1e-12 to 1, not 2; see tank --help");
  CHECK(said("--tags", "0") == "--tags: must be more than 0, not 0; see tank --help");
  CHECK(said("--depth", "deep") == "--depth: deep is no number; see tank --help");
  for (const char* odd : {"nan", "inf"})
    CHECK(said("--depth", odd) == "--depth: " + std::string{odd} + " is not a finite number; see tank --help");
  CHECK(said("--depth", "1e-9").empty());
  CHECK(said("--rest", "0").empty());
  CHECK(said("--share", "1e-12").empty());
  CHECK(said("--share", "1").empty());
  CHECK(said("--tags", "7").empty());
}

}  // namespace fathom::runtime
