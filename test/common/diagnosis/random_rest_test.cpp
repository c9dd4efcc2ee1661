// Which residuals pass for a random force, and which must not.
#include "common/diagnosis/random_rest.hpp"

#include <doctest/doctest.h>

using namespace fathom;
using namespace fathom::diagnosis;

namespace {

AxisWhiteness remembers() {
  return {.axis = "Y", .p_value = 1e-9, .autocorrelation_time_s = 1.5, .explained = 0.98, .applied_rms = 4.0};
}

bool random_along_y(const AxisWhiteness& row, const std::vector<Association>& left = {}, double length = 100.0) {
  const std::vector<AxisWhiteness> rows{{.axis = "X", .p_value = 0.5, .explained = 0.999}, row};
  const auto random = random_rest(rows, left, length);
  for (const std::size_t other : {0U, 2U, 3U, 4U, 5U}) CHECK_FALSE(random[other]);
  return random[1];
}

}  // namespace

TEST_CASE("random rest: large, with a memory, and gone with nothing") {
  CHECK(random_along_y(remembers()));
  CHECK(random_along_y(remembers(), {{.axis = "X", .with = "depth", .share = 0.3}}));
  CHECK_FALSE(random_along_y(remembers(), {{.axis = "Y", .with = "depth", .share = 0.3}}));
  CHECK_FALSE(random_along_y(remembers(), {}, 25.0));  // fewer than twenty memories long
  AxisWhiteness white = remembers(), quick = remembers(), small = remembers();
  white.p_value = 0.2;
  quick.autocorrelation_time_s = 0.3;
  small.explained = 0.999;  // 3 % of the wrench: structure in it might not show
  for (const AxisWhiteness& row : {white, quick, small}) CHECK_FALSE(random_along_y(row));
}
