// What else is green on the floor, and what the laser's range makes of it.
#include "test/common/vision/rival_spots.hpp"

#include <doctest/doctest.h>

#include <array>
#include <cstdio>
#include <utility>

namespace fathom::vision {
namespace {

using namespace test_scene;

constexpr std::array kMovings{Moving::kRest, Moving::kAlong, Moving::kDown, Moving::kAll};
constexpr int kDives = 6, kPictures = 20;
constexpr RenderSettings kLook{.caustics = 0.3};

const char* name_of(Moving moving) {
  constexpr std::array<const char*, 4> kNames{"at rest", "along the floor", "up and down", "all ways"};
  return kNames[static_cast<std::size_t>(moving)];
}

const char* name_of(Rival rival) {
  constexpr std::array<const char*, 4> kNames{"none", "paint", "paint, laser off", "second beam"};
  return kNames[static_cast<std::size_t>(rival)];
}

}  // namespace

TEST_CASE("laser: a dot alone is told at rest, in descent and under way, with tags and without") {
  for (const Moving moving : kMovings) {
    for (const bool tags : {false, true}) {
      CAPTURE(name_of(moving));
      CAPTURE(tags);
      const Tally t = dive({.tags = tags, .moving = moving, .look = kLook}, kDives, kPictures, 60);
      CHECK(t.looked == kDives * kPictures);
      CHECK(t.found >= t.looked * 95 / 100);
      CHECK(t.wrong == 0);
    }
  }
}

TEST_CASE("laser: a painted spot is no dot as soon as the floor moves, with the laser on and off") {
  for (const Rival rival : {Rival::kPaint, Rival::kPaintAlone}) {
    for (const Moving moving : {Moving::kAlong, Moving::kAll}) {
      for (const int quality : {0, 75}) {
        CAPTURE(name_of(rival));
        CAPTURE(name_of(moving));
        CAPTURE(quality);
        const Tally t =
            dive({.moving = moving, .rival = rival, .look = kLook, .quality = quality}, kDives, kPictures, 61);
        CHECK(t.late == 0);
        CHECK(t.wrong <= kPictures);
        // While the paint is away from the beam, or is known, the dot is told.
        if (rival == Rival::kPaint) CHECK(t.found > t.looked / 3);
      }
    }
  }
}

TEST_CASE("laser: where nothing moves tags tell paint from the dot, but for paint that lies where the dot would be") {
  constexpr int kMany = 12;
  const Tally t =
      dive({.tags = true, .moving = Moving::kRest, .rival = Rival::kPaintAlone, .look = kLook}, kMany, 4, 62);
  CHECK(t.dives_wrong <= kMany / 3);
}

TEST_CASE("laser: of paint and a dot, or two beams, none is told at rest, or its error takes in both") {
  for (const Rival rival : {Rival::kPaint, Rival::kSecondBeam}) {
    CAPTURE(name_of(rival));
    const Tally t = dive({.moving = Moving::kRest, .rival = rival, .look = kLook}, 12, 4, 63);
    CHECK(t.dives_wrong <= 1);
  }
}

TEST_CASE("laser: what takes the dot's place elsewhere is not believed before it moved with the beam") {
  constexpr int kBefore = 6;
  model::LaserMount mirrored = laser();
  mirrored.p_CE.x() = 0.09;
  Renderer own{bare_site(), lens(), laser(), {}, 19}, other{bare_site(), lens(), mirrored, {}, 19};
  FrontEnd front_end{bare_site(), lens(), laser(), {}};
  const Pose at = pose({0.1, 0.0, 0.5}, 0.02, 0.01, 0.4);
  for (int i = 0; i < 2 * kBefore; ++i) {
    const Picture seen = picture(i < kBefore ? own : other, i / 30.0, at);
    const LaserDot dot = front_end.step(seen, at.R_WC).laser.value();
    CHECK(dot.state == (i < kBefore ? LaserState::kFound : LaserState::kJumped));
  }
  CHECK_FALSE(front_end.laser_range("down"));
}

TEST_CASE("laser: a glint that stays in the picture is not told where tags have the floor elsewhere") {
  constexpr double kNearer = 0.6;  // m, where the beam would be seen at its place
  Renderer renderer{site(), lens(), laser(), {.laser = 0.6}, 21};
  FrontEnd front_end{site(), lens(), laser(), {}};
  const Eigen::Vector2d glint = Projection{lens()}.pixel({laser().p_CE.x(), 0.0, kNearer});
  int told = 0, refused = 0;
  for (int i = 0; i < 40; ++i) {
    const double t = i / 30.0;
    const Pose at = pose({0.2 * t, 0.1 * t, 0.4 + 0.1 * std::sin(2.0 * t)}, 0.05 * std::sin(t), 0.02, 0.2 * t);
    cv::Mat bgr = renderer.step(t, at).clone();
    add_spot(bgr, glint, 2.0, 1.5);
    const Sight& sight =
        front_end.step({.utime = utime_after(1'000'000, t), .grey = grey_of(bgr), .bgr = bgr}, at.R_WC);
    REQUIRE(sight.fix);
    REQUIRE(sight.fix->n_tags > 1);
    refused += sight.laser->state == LaserState::kAgainstTags ? 1 : 0;
    if (sight.laser->state != LaserState::kFound) continue;
    ++told;
    CHECK(std::abs(sight.laser->p_CL.z() - renderer.dot(at)->z()) < 3.0 * sight.laser->sigma_range);
  }
  MESSAGE("told " << told << ", refused " << refused << " of 40");
  CHECK(refused > 20);
}

TEST_CASE("flow: the laser's dot and other bright spots do not outshine a bare floor") {
  for (const double second : {0.0, 2.0}) {
    CAPTURE(second);
    Renderer renderer{bare_site(), lens(), laser(), {.texture = 0.15}, 20};
    FrontEnd front_end{bare_site(), lens(), laser(), {}};
    for (int i = 0; i < 10; ++i) {
      const Pose at = pose({0.01 * i, 0.0, 0.4});
      cv::Mat bgr = renderer.step(i / 30.0, at).clone();
      if (second > 0.0) add_spot(bgr, {200.0 - 5.4 / 1.1 * i, 150.0}, 2.0, second);
      front_end.step({.utime = utime_after(0, i / 30.0), .grey = grey_of(bgr), .bgr = bgr}, at.R_WC);
      if (i > 0) CHECK(front_end.sight().flow.state == FlowState::kValid);
    }
  }
}

// The table of docs/vision.md: build/check/test/test_common_vision -tc="laser: the table of rivals*" --no-skip
TEST_CASE("laser: the table of rivals of the dot" * doctest::skip()) {
  constexpr int kMany = 10, kLong = 30;
  for (const Rival rival : {Rival::kNone, Rival::kPaint, Rival::kPaintAlone, Rival::kSecondBeam}) {
    for (const Moving moving : kMovings) {
      std::printf("| %s | %s |", name_of(rival), name_of(moving));
      for (const auto& [tags, quality] : {std::pair{false, 0}, {true, 0}, {false, 75}, {true, 75}}) {
        const Setting setting{.tags = tags, .moving = moving, .rival = rival, .look = kLook, .quality = quality};
        const Tally t = dive(setting, kMany, kLong, 40);
        std::printf(" %d of %d, %d |", t.found, t.looked, t.wrong);
        std::fflush(stdout);
      }
      std::printf("\n");
    }
  }
}

}  // namespace fathom::vision
