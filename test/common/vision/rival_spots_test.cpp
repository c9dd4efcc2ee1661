// What else is green on the floor, and what the laser's range makes of it.
#include <doctest/doctest.h>

#include <cstdio>

#include "test/common/vision/rival_spots.hpp"

namespace fathom::vision {
namespace {

using namespace test_scene;

const char* name_of(Moving moving) {
  constexpr std::array<const char*, 4> kNames{"at rest", "along the floor", "up and down", "all ways"};
  return kNames[static_cast<std::size_t>(moving)];
}

const char* name_of(Rival rival) {
  constexpr std::array<const char*, 4> kNames{"none", "paint", "paint, laser off", "second beam"};
  return kNames[static_cast<std::size_t>(rival)];
}

}  // namespace

// The table of docs/vision.md: build/dev/test/test_common_vision -tc="laser: the table of rivals*" --no-skip
TEST_CASE("laser: the table of rivals of the dot" * doctest::skip()) {
  constexpr int kDives = 10, kPictures = 30;
  for (const Rival rival : {Rival::kNone, Rival::kPaint, Rival::kPaintAlone, Rival::kSecondBeam}) {
    if (std::getenv("R") && std::atoi(std::getenv("R")) != static_cast<int>(rival)) continue;
    for (const Moving moving : {Moving::kRest, Moving::kAlong, Moving::kDown, Moving::kAll}) {
    if (std::getenv("M") && std::atoi(std::getenv("M")) != static_cast<int>(moving)) continue;
      std::printf("| %s | %s |", name_of(rival), name_of(moving));
      for (const auto& [tags, quality] : {std::pair{false, 0}, {true, 0}, {false, 75}, {true, 75}}) {
        const Tally t = dive(
            {.tags = tags, .moving = moving, .rival = rival, .look = {.caustics = 0.3}, .quality = quality}, kDives,
            kPictures, 40);
        std::printf(" %d of %d, wrong %d in %d dives |", t.found, t.looked, t.wrong, t.dives_wrong);
        std::fflush(stdout);
      }
      std::printf("\n");
    }
  }
}

}  // namespace fathom::vision
