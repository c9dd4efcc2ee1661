// Flow on the way, as in a trial by pictures: over tags and bare floor, near and far, in compressed pictures, beside
// what moves with the camera.
#include <doctest/doctest.h>

#include <cstdio>

#include "common/vision/steady_pattern.hpp"
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

TEST_CASE("steady pattern: letters are taken out once the floor has moved behind them, and nothing else ever is") {
  constexpr int kPictures = 60;
  const cv::Size size{320, 240};
  cv::RNG random{7};
  cv::Mat floor(size.height, size.width + 12 * kPictures, CV_8UC1);
  random.fill(floor, cv::RNG::NORMAL, 100.0, 12.0);
  cv::GaussianBlur(floor, floor, {}, 1.0);
  const auto write = [](cv::Mat& on) { cv::putText(on, "12.4 m", {30, 60}, cv::FONT_HERSHEY_SIMPLEX, 0.6, 230.0, 1); };
  cv::Mat letters = cv::Mat::zeros(size, CV_8UC1), clean;
  write(letters);
  for (const bool written : {true, false}) {
    for (const bool moves : {true, false}) {
      CAPTURE(written);
      CAPTURE(moves);
      SteadyPattern pattern;
      cv::Mat seen;
      for (int i = 0; i < kPictures; ++i) {
        floor(cv::Rect{cv::Point{moves ? 12 * i : 0, 0}, size}).copyTo(seen);
        if (written) write(seen);
        pattern.learn(seen, {moves ? -12.0 : 0.0, 0.0});
      }
      pattern.take_out(seen, clean);
      CHECK(pattern.known() == moves);
      cv::Mat change;
      cv::absdiff(seen, clean, change);
      if (!moves || !written) {
        CHECK(cv::countNonZero(change) < seen.rows * seen.cols / 1000);
      } else {
        CHECK(cv::mean(clean, letters)[0] < 0.5 * (100.0 + cv::mean(seen, letters)[0]));
        change.setTo(0, letters);
        CHECK(cv::mean(change)[0] < 0.5);
      }
    }
  }
}

// The table of docs/vision.md: build/dev/test/test_common_vision -tc="flow: the table of flights" --no-skip
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
