#include "common/base/near_name.hpp"

#include <doctest/doctest.h>

using fathom::looks_like;

TEST_CASE("near name: slips of the keyboard look alike, other words do not") {
  CHECK(looks_like("mas", "mass"));
  CHECK(looks_like("dfo", "dof"));
  CHECK(looks_like("bouyancy", "buoyancy"));
  CHECK(looks_like("Max-Gap", "max_gap"));
  CHECK(looks_like("water_densty", "water_density"));
  CHECK_FALSE(looks_like("X", "Y"));
  CHECK_FALSE(looks_like("mass", "drag"));
  CHECK_FALSE(looks_like("name", "mass"));
  CHECK_FALSE(looks_like("", "mass"));
}
