// The word that arms: read as it is written, refused when anybody could guess it.
#include "common/base/operator_token.hpp"

#include <doctest/doctest.h>

#include <fstream>

#include "common/base/error.hpp"
#include "test/support/scratch.hpp"

using namespace fathom;

namespace {

std::string complaint(const std::string& text) {
  const test::Scratch scratch;
  std::ofstream{scratch.path("operator.yaml")} << text;
  try {
    return "read as " + operator_token(scratch.path("operator.yaml"));
  } catch (const InputError& error) {
    return error.what();
  }
}

bool has(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

}  // namespace

TEST_CASE("operator token: comes back as it was written") {
  CHECK(complaint("operator:\n  token: deep-blue-4711\n") == "read as deep-blue-4711");
}

TEST_CASE("operator token: short words, missing words and unknown keys are refused with file and line") {
  const std::string brief = complaint("operator:\n  token: sesame\n");
  CHECK(has(brief, "operator.yaml:2"));
  CHECK(has(brief, "shorter than eight"));
  CHECK(has(complaint("operator: {}\n"), "token"));
  CHECK(has(complaint("operator:\n  token: deep-blue-4711\n  tokken: x\n"), "operator.yaml:3"));
  CHECK(has(complaint("vehicle: {}\n"), "operator"));
}

TEST_CASE("operator token: a file that is not there is named") {
  CHECK_THROWS_WITH_AS(operator_token("/nowhere/operator.yaml"), doctest::Contains("/nowhere/operator.yaml"),
                       InputError);
}
