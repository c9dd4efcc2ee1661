// The laser's dot in pictures that a camera compressed itself, with colour at half resolution.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <opencv2/imgcodecs.hpp>

#include "common/vision/jpeg.hpp"
#include "test/common/vision/scene.hpp"

namespace fathom::vision {
namespace {

using namespace test_scene;

struct Errors {
  int looked{}, found{}, beyond{};  // beyond: three times what is stated
  double rms{};                     // px, along the beam's line
};

// As OpenCV's writer compresses: 4:2:0. The dot wanders over floor and tags, near and far.
Errors compressed(const RenderSettings& look, const model::Site& place, int quality, bool told) {
  Renderer renderer{place, lens(), laser(), look, 5};
  LaserFinder finder{lens(), laser(), {}};
  const Projection projection{lens()};
  Errors errors;
  double squares = 0.0;
  for (int i = 0; i < 80; ++i) {
    const Pose at = pose({0.3 * std::sin(1.3 * i), 0.3 * std::cos(2.1 * i), 0.5 + 0.45 * std::sin(0.7 * i)},
                         0.05 * std::sin(0.9 * i), 0.05 * std::cos(0.4 * i), 0.1 * i);
    const cv::Mat& bgr = renderer.step(0.1 * i, at);
    const auto truth = renderer.dot(at);
    REQUIRE(truth);
    std::vector<std::uint8_t> bytes;
    REQUIRE(cv::imencode(".jpg", bgr, bytes, {cv::IMWRITE_JPEG_QUALITY, quality}));
    REQUIRE(halves_colour(bytes));
    cv::Mat grey, read;
    REQUIRE(decode_jpeg(bytes, true, grey, read).empty());
    ++errors.looked;
    const LaserDot dot = finder.step(read, grey, told);
    if (dot.state != LaserState::kFound) continue;
    ++errors.found;
    if (std::abs(dot.p_CL.z() - truth->z()) > 3.0 * dot.sigma_range) ++errors.beyond;
    squares += std::pow(dot.pixel.x() - projection.pixel(*truth).x(), 2);
  }
  errors.rms = std::sqrt(squares / std::max(errors.found, 1));
  return errors;
}

}  // namespace

TEST_CASE("laser: halved colour does not move the dot, brightness says where it is, and errors are what is stated") {
  model::Site bare = site();
  bare.tags.clear();
  for (const int quality : {90, 75, 50}) {
    CAPTURE(quality);
    const Errors floor = compressed({}, bare, quality, true);
    CHECK(floor.found == floor.looked);
    CHECK(floor.rms < 0.2);
    CHECK(floor.beyond == 0);
    // Were it not told, it would err by more where the coder left little of the colour.
    if (quality < 90) CHECK(compressed({}, bare, quality, false).rms > 1.3 * floor.rms);
    const Errors tags = compressed({}, site(), quality, true);
    CHECK(tags.found > tags.looked * 2 / 3);
    CHECK(tags.beyond <= 1);
    const Errors weak = compressed({.laser = 0.5}, site(), quality, true);
    CHECK(weak.beyond <= 1);
  }
}

TEST_CASE("laser: halved colour makes no dot where there is none") {
  for (const int quality : {90, 75, 50}) {
    CAPTURE(quality);
    CHECK(compressed({.caustics = 0.4, .laser = 0.0}, site(), quality, true).found == 0);
  }
}

}  // namespace fathom::vision
