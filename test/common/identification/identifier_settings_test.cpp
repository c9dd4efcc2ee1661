// The identifier's section of a pipeline file, as read and as refused.
#include <doctest/doctest.h>

#include <string>

#include "common/base/config.hpp"
#include "common/base/error.hpp"
#include "common/identification/identifier.hpp"

using namespace fathom;

namespace {

std::string section(const std::string& input) {
  return "window: 2 s\nstride: 500 ms\nmax_gap: 0.35 s\nmemory: 600 s\nnoise_force: 0.5 N\nnoise_moment: 0.1 N "
         "m\ninput: " +
         input + "\nmax_input_gap: 0.5 s\nmax_skew: 0.5 s\nbuoyant: true\n";
}

}  // namespace

TEST_CASE("identifier settings: read with their units, nothing left over") {
  const Config config = Config::parse(section("hold"), "pipeline.yaml");
  const identification::IdentifierSettings s = identification::IdentifierSettings::from(config);
  config.finish();
  CHECK(s.window == doctest::Approx(2.0));
  CHECK(s.stride == doctest::Approx(0.5));
  CHECK(s.memory == doctest::Approx(600.0));
  CHECK_FALSE(s.interpolate_input);
  CHECK(s.buoyant);
}

TEST_CASE("identifier settings: an unknown way to treat inputs is refused with file and line") {
  const Config config = Config::parse(section("cubic"), "pipeline.yaml");
  CHECK_THROWS_WITH_AS((void)identification::IdentifierSettings::from(config), doctest::Contains("pipeline.yaml:7"),
                       InputError);
}
