// The laser's dot in pictures that a camera compressed itself, with colour at half resolution.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <opencv2/imgcodecs.hpp>
#include <random>

#include "common/vision/jpeg.hpp"
#include "test/common/vision/scene.hpp"

namespace fathom::vision {
namespace {

using namespace test_scene;

enum class Colour { kFull, kHalf, kQuarter };  // 4:4:4, 4:2:2, 4:2:0

struct Coder {
  Colour colour{Colour::kQuarter};
  int quality{90};
};

std::vector<std::uint8_t> encoded(const cv::Mat& bgr, const Coder& coder) {
  if (coder.colour != Colour::kQuarter) return encode_jpeg(bgr, coder.quality, coder.colour == Colour::kHalf);
  std::vector<std::uint8_t> bytes;  // OpenCV's writer
  REQUIRE(cv::imencode(".jpg", bgr, bytes, {cv::IMWRITE_JPEG_QUALITY, coder.quality}));
  return bytes;
}

struct Errors {
  int looked{}, found{}, beyond{};  // beyond: three times what is stated
  double rms{}, range_rms{};        // px, along the beam's line; m
};

// The dot wanders over the floor, 0.4 to 1.5 m away. `told`: that colour is halved, where it is.
Errors measure(const model::Site& place, const RenderSettings& look, const Coder& coder, int views, bool told = true) {
  Renderer renderer{place, lens(), laser(), look, 5};
  LaserFinder finder{lens(), laser(), {}};
  const Projection projection{lens()};
  std::mt19937 generator{3};
  std::uniform_real_distribution<double> any{-1.0, 1.0};
  Errors errors;
  for (int i = 0; i < views; ++i) {
    const double x = any(generator), y = any(generator), z = any(generator), roll = any(generator),
                 pitch = any(generator), yaw = any(generator);
    const Pose at = pose({0.3 * x, 0.3 * y, 0.55 + 0.55 * z}, 0.1 * roll, 0.1 * pitch, 3.0 * yaw);
    const auto truth = renderer.dot(at);
    if (!truth) continue;
    const std::vector<std::uint8_t> bytes = encoded(renderer.step(0.1 * i, at), coder);
    cv::Mat grey, bgr;
    REQUIRE(decode_jpeg(bytes, true, grey, bgr).empty());
    REQUIRE(halves_colour(bytes) == (coder.colour != Colour::kFull));
    ++errors.looked;
    const LaserDot dot = finder.step(bgr, grey, told && halves_colour(bytes));
    if (dot.state != LaserState::kFound) continue;
    ++errors.found;
    const double range = dot.p_CL.z() - truth->z();
    if (std::abs(range) > 3.0 * dot.sigma_range) ++errors.beyond;
    errors.range_rms += range * range;
    errors.rms += std::pow(dot.pixel.x() - projection.pixel(*truth).x(), 2);
  }
  errors.rms = std::sqrt(errors.rms / std::max(errors.found, 1));
  errors.range_rms = std::sqrt(errors.range_rms / std::max(errors.found, 1));
  return errors;
}

model::Site bare() {
  model::Site place = site();
  place.tags.clear();
  return place;
}

/// Tags of 10 cm with 2.5 cm of paper between them.
model::Site paper() {
  model::Site place = bare();
  for (int i = 0; i < 400; ++i) {
    place.tags.push_back({.id = i, .size = 0.10, .p_WT = {0.125 * (i % 20 - 10), 0.125 * (i / 20 - 10), 1.5}});
  }
  return place;
}

}  // namespace

TEST_CASE("laser: halved colour does not move the dot, brightness says where it is, and errors are what is stated") {
  constexpr int kViews = 80;
  for (const int quality : {90, 75, 50}) {
    CAPTURE(quality);
    const Coder coder{.quality = quality};
    const Errors floor = measure(bare(), {}, coder, kViews);
    CHECK(floor.found == floor.looked);
    CHECK(floor.rms < 0.2);
    CHECK(floor.beyond == 0);
    // Were it not told, it would err by more where the coder left little of the colour.
    if (quality < 90) CHECK(measure(bare(), {}, coder, kViews, false).rms > 1.3 * floor.rms);
    const Errors tags = measure(site(), {}, coder, kViews);
    CHECK(tags.found > tags.looked * 2 / 3);
    CHECK(tags.beyond <= 1);
    CHECK(measure(site(), {.laser = 0.5}, coder, kViews).beyond <= 1);
  }
}

TEST_CASE("laser: halved colour makes no dot where there is none") {
  for (const int quality : {90, 75, 50}) {
    CAPTURE(quality);
    CHECK(measure(site(), {.caustics = 0.4, .laser = 0.0}, {.quality = quality}, 80).found == 0);
  }
}

// The table of docs/vision.md: build/check/test/test_common_pictures -tc="laser: the table*" --no-skip
TEST_CASE("laser: the table of what compression costs" * doctest::skip()) {
  constexpr int kViews = 600;
  const std::vector<std::tuple<const char*, model::Site, RenderSettings>> places{
      {"floor", bare(), {}},
      {"tags and floor", site(), {}},
      {"strong texture, caustics", bare(), {.caustics = 0.3, .texture = 0.6}},
      {"floor, dot a third as bright", bare(), {.laser = 0.5}},
      {"tags, dot a third as bright", site(), {.laser = 0.5}},
      {"tags, turbid", site(), {.attenuation = 1.0, .blur = 1.5}},
      {"paper full of tags", paper(), {}}};
  const std::vector<Coder> coders{
      {Colour::kFull, 90}, {Colour::kHalf, 90}, {Colour::kQuarter, 90}, {Colour::kQuarter, 75}, {Colour::kQuarter, 50}};
  for (const auto& [name, place, look] : places) {
    std::printf("| %s |", name);
    for (const Coder& coder : coders) {
      const Errors e = measure(place, look, coder, kViews);
      std::printf(" %.2f (%d, %.0f, %d) |", e.rms, e.found, 1e3 * e.range_rms, e.beyond);
      CHECK(e.beyond <= kViews / 100);
    }
    std::printf("\n");
  }
  const Errors untold = measure(site(), {}, {.quality = 75}, kViews, false);
  std::printf("untold, tags, 4:2:0, 75: %.2f px, beyond %d of %d\n", untold.rms, untold.beyond, untold.found);
}

}  // namespace fathom::vision
