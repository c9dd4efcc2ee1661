// The diagnoser's section of a pipeline file: every key is needed, and nonsense is refused where it stands.
#include "common/live/live_settings.hpp"

#include <doctest/doctest.h>

#include <string>

#include "common/base/config.hpp"
#include "common/base/error.hpp"
#include "test/support/scratch.hpp"

namespace fathom::live {
namespace {

const std::string kText = "first_look: 40 s\ninterval: 5 s\nmax_skew: 500 ms\nkeep: 300 s\n";

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
  const LiveSettings s = LiveSettings::from(Config::parse(kText + "threads: 3\n", "p.yaml"));
  CHECK(s.first_look == 40.0);
  CHECK(s.interval == 5.0);
  CHECK(s.max_skew == doctest::Approx(0.5));
  CHECK(s.keep == 300.0);
  CHECK(s.threads == 3);
  CHECK(LiveSettings::from(Config::parse(kText, "p.yaml")).threads == LiveSettings{}.threads);
}

TEST_CASE("live settings: no key but threads has a default") {
  for (const char* key : {"first_look", "interval", "max_skew", "keep"}) {
    CHECK(complaint(with(key, "")) == std::string("p.yaml:1: key '") + key + "' is missing");
  }
}

TEST_CASE("live settings: nonsense is refused with its line") {
  for (const char* key : {"first_look", "interval", "keep"}) {
    CHECK(complaint(with(key, "0 s")).find(std::string("'") + key + "' must be positive") != std::string::npos);
  }
  CHECK(complaint(with("max_skew", "-1 s")) == "p.yaml:3: 'max_skew' must not be negative");
  CHECK(complaint(kText + "threads: 0\n") == "p.yaml:5: 'threads' must be 1 at least");
  CHECK(complaint(kText + "intervall: 1 s\n") == "p.yaml:5: unknown key 'intervall'; did you mean 'interval'?");
}

}  // namespace fathom::live
