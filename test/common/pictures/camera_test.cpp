// A camera's stamps, and what is said where there is no camera.
#include "common/pictures/camera.hpp"

#include <doctest/doctest.h>

#include <cmath>

#include "common/base/error.hpp"

namespace fathom::pictures {

TEST_CASE("camera: a stamp is of the clock that makes it a moment ago, or of none") {
  constexpr double kMonotonic = 36'000.0, kWall = 1.79e9, kExact = 1e-6;
  REQUIRE(age_of_stamp(kMonotonic - 0.04, kMonotonic, kWall));
  CHECK(*age_of_stamp(kMonotonic - 0.04, kMonotonic, kWall) == doctest::Approx(0.04).epsilon(kExact));
  CHECK(*age_of_stamp(kWall - 0.04, kMonotonic, kWall) == doctest::Approx(0.04).epsilon(1e-4));
  REQUIRE(age_of_stamp(kMonotonic + 0.08, kMonotonic, kWall));  // the end of an exposure that lasts
  CHECK(*age_of_stamp(kMonotonic + 0.08, kMonotonic, kWall) == doctest::Approx(-0.08).epsilon(kExact));
  for (const double never : {0.0, -1.0, kMonotonic - 10.0, kMonotonic + 1.0, kWall + 60.0, std::nan("")}) {
    CHECK_FALSE(age_of_stamp(never, kMonotonic, kWall));
  }
}

TEST_CASE("camera: none, not one, or an impossible format are InputErrors that name the device") {
  for (const char* device : {"/dev/video987", "/dev/null", "/nowhere/at/all"}) {
    CHECK_THROWS_WITH_AS(static_cast<void>(open_camera({.device = device})),
                         doctest::Contains(std::string{device}.c_str()), InputError);
  }
  CHECK_THROWS_AS(static_cast<void>(open_camera({.device = "/dev/null", .format = "JPG"})), InputError);
}

}  // namespace fathom::pictures
