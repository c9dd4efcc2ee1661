// Causes as data: each of them described in the schema.
#include "common/result/cause_words.hpp"

#include <doctest/doctest.h>

#include <nlohmann/json.hpp>

#include "test/support/scratch.hpp"

using namespace fathom;

TEST_CASE("causes: the schema lists the same as the program, each with its quantity") {
  const auto schema =
      nlohmann::json::parse(test::read_bytes(std::string{FATHOM_SOURCE_DIR} + "/docs/schema/diagnosis-2.schema.json"));
  const auto& listed = schema.at("properties").at("causes").at("items").at("properties").at("cause").at("oneOf");
  REQUIRE(listed.size() == result::cause_words().size());
  for (std::size_t i = 0; i < listed.size(); ++i) {
    const result::CauseWords& words = result::cause_words()[i];
    CHECK(listed[i].at("const") == words.cause);
    const std::string described = listed[i].at("description");
    CHECK(described.starts_with(std::string{words.sentence} + "."));
    CHECK(described.find(std::string{words.quantity}) != std::string::npos);
  }
}
