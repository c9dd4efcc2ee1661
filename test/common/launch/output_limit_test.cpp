// What a program prints is passed on, but not without measure.
#include "common/launch/output_limit.hpp"

#include <doctest/doctest.h>

namespace fathom::launch {

TEST_CASE("output: small pieces wait for each other, many bytes do not") {
  OutputLimit output;
  output.add("a", "one", 5.0);
  CHECK(output.take(5.0).size() == 1);
  output.add("a", "two ", 5.001);
  output.add("b", "x", 5.002);
  output.add("a", "three", 5.003);
  CHECK(output.take(5.004).empty());
  CHECK(output.waiting());
  const auto texts = output.take(5.011);
  REQUIRE(texts.size() == 2);
  CHECK(texts[0].text == "two three");
  CHECK(texts[1].id == "b");
  CHECK_FALSE(output.waiting());
  output.add("a", std::string(5000, 'x'), 5.012);
  CHECK(output.take(5.012).size() == 1);
}

TEST_CASE("output: a flood is held to its rate, the loss is counted, others are not hindered") {
  OutputLimit output;
  std::size_t told = 0;
  for (int i = 0; i < 10'000; ++i) {  // ten seconds of a megabyte a second
    output.add("flood", std::string(1000, 'x'), 0.001 * i);
    for (const auto& each : output.take(0.001 * i)) told += each.text.size();
  }
  CHECK(static_cast<double>(told) < 1.2 * (OutputLimit::kBurst + 10.0 * OutputLimit::kRate));
  CHECK(static_cast<double>(told) > 0.8 * (OutputLimit::kBurst + 10.0 * OutputLimit::kRate));
  output.add("quiet", "hello", 10.0);
  output.add("flood", "end", 12.0);
  const auto texts = output.take(12.0);
  REQUIRE(texts.size() == 2);
  CHECK(texts[0].text.find("bytes of output not told]\r\nend") != std::string::npos);
  CHECK(texts[1].text == "hello");
}

}  // namespace fathom::launch
