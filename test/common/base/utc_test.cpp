#include "common/base/utc.hpp"

#include <doctest/doctest.h>

namespace fathom {

TEST_CASE("utc: stamps as dates, and none of a clock that began at zero") {
  CHECK(utc_text(1'716'802'800'500'000) == "2024-05-27T09:40:00.500Z");
  CHECK(utc_text(1'709'164'799'999'999) == "2024-02-28T23:59:59.999Z");  // a leap year's day before the 29th
  CHECK_FALSE(utc_text(0));
  CHECK_FALSE(utc_text(3'600'000'000));
  CHECK_FALSE(utc_text(-1));
  CHECK_FALSE(utc_text(INT64_MAX));
}

}  // namespace fathom
