// Boundaries are ruled out by where the vehicle has been, however long it was there.
#include "common/diagnosis/places.hpp"

#include <doctest/doctest.h>

using namespace fathom;

TEST_CASE("places: a wall or floor stands where the vehicle was not, and takes no drag away") {
  const model::Effect& floor = *model::find_effect("bottom_effect");
  const model::Effect& wall = *model::find_effect("wall_effect");
  constexpr int kForce = 0, kDrag = 1;
  diagnosis::Places places;
  for (int k = 0; k < 100'000; ++k) places.add({0.01 * (k % 300), 0.0, 1.0 + 0.001 * (k % 1000)});
  CHECK(places.size() > 100);
  CHECK(places.size() < 513);
  CHECK(places.rule_out(floor, std::vector{1.0, 1.5}, kForce));
  CHECK_FALSE(places.rule_out(floor, std::vector{1.0, 2.1}, kForce));
  CHECK_FALSE(places.rule_out(floor, std::vector{-1.0, 2.1}, kForce));  // suction
  CHECK(places.rule_out(floor, std::vector{-1.0, 2.1}, kDrag));
  CHECK(places.rule_out(wall, std::vector{1.0, 0.0, 2.0}, kDrag));  // 2 m north
  CHECK_FALSE(places.rule_out(wall, std::vector{1.0, 0.0, 3.1}, kDrag));
  CHECK(places.rule_out(wall, std::vector{-1.0, 0.0, 3.1}, kDrag));
  CHECK_FALSE(places.rule_out(*model::find_effect("current"), std::vector{0.1, 0.1}, 0));
  places.clear();
  CHECK(places.size() == 0);
  CHECK_FALSE(places.rule_out(floor, std::vector{1.0, 1.5}, kForce));
}
