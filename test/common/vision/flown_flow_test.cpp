// Flow on the way, as in a trial by pictures: over tags and bare floor, near and far, in compressed pictures, beside
// what moves with the camera.
#include <doctest/doctest.h>

#include <cstdio>

#include "test/common/vision/flight.hpp"

namespace fathom::vision {
namespace {

using namespace test_scene;

FlightTally fly_some(FlightSettings settings, int flights) {
  FlightTally all;
  for (int i = 0; i < flights; ++i, ++settings.seed) all.add(fly(settings));
  return all;
}

}  // namespace

TEST_CASE("flow: on the way over tags and bare floor, beside the laser's dot, it errs as it says") {
  constexpr double kSpeed = 8e-3, kWorst = 0.1;  // m/s
  constexpr double kStated = 3.0;                // the mean of what is expected
  for (const bool tags : {true, false}) {
    CAPTURE(tags);
    const FlightTally t = fly_some({.tags = tags, .drawn_look = true, .seconds = 3.0, .seed = 504}, 3);
    CHECK(t.valid > t.pairs * 9 / 10);
    CHECK(t.rms() < kSpeed);
    CHECK(t.worst < kWorst);
    CHECK(t.mean_square() < kStated);
  }
}

TEST_CASE("flow: dirt on the window, which moves with the camera, is no floor at rest") {
  constexpr double kSpeed = 0.012, kWorst = 0.15;  // m/s
  constexpr double kStated = 3.0;
  for (const bool tags : {true, false}) {
    CAPTURE(tags);
    const FlightTally t = fly_some({.tags = tags, .dirt = 20, .seconds = 4.0, .seed = 520}, 2);
    CHECK(t.valid > t.pairs * 3 / 4);
    CHECK(t.rms() < kSpeed);
    CHECK(t.worst < kWorst);
    CHECK(t.mean_square() < kStated);
  }
}

// The table of docs/vision.md: build/check/test/test_common_vision -tc="flow: the table of flights" --no-skip
TEST_CASE("flow: the table of flights" * doctest::skip()) {
  constexpr int kFlights = 8;
  for (const int dirt : {0, 20, 60}) {
    for (const bool tags : {true, false}) {
      for (const bool drawn : {false, true}) {
        const FlightTally t =
            fly_some({.tags = tags, .dirt = dirt, .drawn_look = drawn, .seconds = 8.0, .seed = 600}, kFlights);
        std::printf("| %s, %s, %d spots | %d of %d | %.1f | %d | %.1f where %.1f are stated | %.0f |\n",
                    tags ? "tags" : "bare floor", drawn ? "water, light and floor drawn" : "the tank's", dirt, t.valid,
                    t.pairs, t.mean_square(), t.beyond, 1e3 * t.rms(), 1e3 * t.said(), 1e3 * t.worst);
        std::fflush(stdout);
      }
    }
  }
}

}  // namespace fathom::vision
