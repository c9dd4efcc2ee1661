// The file of the key that arms: read as it is written, refused when others may read it or could guess it.
#include "common/base/operator_key.hpp"

#include <doctest/doctest.h>
#include <sys/stat.h>

#include <fstream>

#include "common/base/error.hpp"
#include "test/support/scratch.hpp"

using namespace fathom;

namespace {

const std::string kHex = "000102030405060708090a0b0c0d0e0f101112131415161718191a1b1c1d1e1F";

std::string complaint(const std::string& text, mode_t mode = 0600) {
  const test::Scratch scratch;
  const std::string path = scratch.path("operator.yaml");
  std::ofstream{path} << text;
  chmod(path.c_str(), mode);
  try {
    Key key{};
    for (std::size_t i = 0; i < key.size(); ++i) key[i] = static_cast<std::uint8_t>(i);
    return operator_keys(path).order == keys_from(key).order ? "read as it is written" : "read as another";
  } catch (const InputError& error) {
    return error.what();
  }
}

bool has(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

}  // namespace

TEST_CASE("operator key: comes back as it was written, and each purpose has its own") {
  CHECK(complaint("operator:\n  key: " + kHex + "\n") == "read as it is written");
  const OperatorKeys keys = keys_from(Key{});
  CHECK(keys.order != keys.command);
  CHECK(keys.order != keys.answer);
  CHECK(keys.command != keys.answer);
}

TEST_CASE("operator key: short, missing and unknown keys, and the words of before, are refused with file and line") {
  CHECK(has(complaint("operator:\n  key: sesame\n"), "operator.yaml:2"));
  CHECK(has(complaint("operator:\n  key: " + kHex.substr(2) + "\n"), "not 64 hex digits"));
  CHECK(has(complaint("operator:\n  key: x" + kHex.substr(1) + "\n"), "not 64 hex digits"));
  CHECK(has(complaint("operator:\n  token: deep-blue-4711\n"), "no longer enough"));
  CHECK(has(complaint("operator: {}\n"), "key"));
  CHECK(has(complaint("operator:\n  key: " + kHex + "\n  kez: x\n"), "operator.yaml:3"));
  CHECK(has(complaint("vehicle: {}\n"), "operator"));
  CHECK_THROWS_WITH_AS((void)operator_keys("/nowhere/operator.yaml"), doctest::Contains("/nowhere/operator.yaml"),
                       InputError);
}

TEST_CASE("operator key: a file that others may read is refused, unless it says that everybody knows it") {
  for (const mode_t mode : {0640, 0604, 0620}) {
    CAPTURE(mode);
    CHECK(has(complaint("operator:\n  key: " + kHex + "\n", mode), "chmod 600"));
    CHECK(complaint("operator:\n  key: " + kHex + "\n  known_to_all: yes\n", mode) == "read as it is written");
  }
}
