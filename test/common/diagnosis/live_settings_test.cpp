// The diagnoser's section of a pipeline file: every key is needed, and nonsense is refused where it stands.
#include <doctest/doctest.h>

#include <string>

#include "common/base/config.hpp"
#include "common/base/error.hpp"
#include "common/diagnosis/live_diagnoser.hpp"
#include "test/support/scratch.hpp"

namespace fathom::diagnosis {
namespace {

const std::string kText =
    "window: 2 s\nstride: 1 s\nmax_gap: 0.35 s\nwarm_up: 30 s\nblock: 10 s\nfewest_blocks: 6\nmost_blocks: 200\n"
    "accept_log_odds: 3.5\nsmallest_reduction: 0.005\nalias_correlation: 0.9\nalternative_log_odds: 2.5\n"
    "input: hold\nmax_input_gap: 0.6 s\nmax_skew: 500 ms\n";

/// The text with one key's value replaced (the line left out when there is none).
std::string with(const std::string& key, const std::string& value) {
  std::string text = kText;
  const auto begin = ("\n" + text).find("\n" + key + ":");
  const auto end = text.find('\n', begin) + 1;
  return text.replace(begin, end - begin, value.empty() ? "" : key + ": " + value + "\n");
}

std::string complaint(const std::string& text) {
  return test::complaint_of<InputError>([&] {
    const Config config = Config::parse(text, "p.yaml");
    (void)LiveSettings::from(config);
    config.finish();
  });
}

}  // namespace

TEST_CASE("live settings: every number arrives where it belongs") {
  CHECK(complaint(kText).empty());
  const LiveSettings s = LiveSettings::from(Config::parse(kText, "p.yaml"));
  CHECK(s.window == 2.0);
  CHECK(s.stride == 1.0);
  CHECK(s.max_gap == 0.35);
  CHECK(s.warm_up == 30.0);
  CHECK(s.block == 10.0);
  CHECK(s.fewest_blocks == 6);
  CHECK(s.most_blocks == 200);
  CHECK(s.accept_log_odds == 3.5);
  CHECK(s.smallest_reduction == 0.005);
  CHECK(s.alias_correlation == 0.9);
  CHECK(s.alternative_log_odds == 2.5);
  CHECK_FALSE(s.interpolate_input);
  CHECK(s.max_input_gap == 0.6);
  CHECK(s.max_skew == doctest::Approx(0.5));
  CHECK(LiveSettings::from(Config::parse(with("input", "linear"), "p.yaml")).interpolate_input);
  CHECK(s.largest_ratio == 0.0);
  CHECK(LiveSettings::from(Config::parse(kText + "largest_ratio: 2\n", "p.yaml")).largest_ratio == 2.0);
}

TEST_CASE("live settings: no key has a default") {
  for (const char* key :
       {"window", "stride", "max_gap", "warm_up", "block", "fewest_blocks", "most_blocks", "accept_log_odds",
        "smallest_reduction", "alias_correlation", "alternative_log_odds", "input", "max_input_gap", "max_skew"}) {
    CHECK(complaint(with(key, "")) == std::string("p.yaml:1: key '") + key + "' is missing");
  }
}

TEST_CASE("live settings: nonsense is refused with its line") {
  for (const char* key : {"window", "stride", "max_gap", "warm_up", "block", "max_input_gap"}) {
    CHECK(complaint(with(key, "0 s")).find(std::string("'") + key + "' must be positive") != std::string::npos);
  }
  CHECK(complaint(with("max_skew", "-1 s")) == "p.yaml:14: 'max_skew' must not be negative");
  CHECK(complaint(with("fewest_blocks", "2")).rfind("p.yaml:6: 'fewest_blocks' must be 3 at least", 0) == 0);
  CHECK(complaint(with("most_blocks", "11")).rfind("p.yaml:7: 'most_blocks' must be twice", 0) == 0);
  CHECK(complaint(with("input", "held")) == "p.yaml:12: 'input' must be linear or hold, not 'held'");
  CHECK(complaint(kText + "windw: 1 s\n") == "p.yaml:15: unknown key 'windw'; did you mean 'window'?");
}

}  // namespace fathom::diagnosis
