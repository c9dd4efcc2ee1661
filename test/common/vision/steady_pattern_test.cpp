// What stays in the picture while the floor moves, and only that.
#include "common/vision/flow/steady_pattern.hpp"

#include <doctest/doctest.h>

#include <opencv2/imgproc.hpp>

namespace fathom::vision {
namespace {

constexpr int kStep = 12;  // px between two pictures
const cv::Size kSize{320, 240};

cv::Mat floor_of(int pictures, std::uint64_t seed) {
  cv::RNG random{seed};
  cv::Mat floor(kSize.height, kSize.width + kStep * pictures, CV_8UC1);
  random.fill(floor, cv::RNG::NORMAL, 100.0, 12.0);
  cv::GaussianBlur(floor, floor, {}, 1.0);
  return floor;
}

void write(cv::Mat& on) { cv::putText(on, "12.4 m", {30, 60}, cv::FONT_HERSHEY_SIMPLEX, 0.6, 230.0, 1); }

}  // namespace

TEST_CASE("steady pattern: letters are taken out once the floor has moved behind them, and nothing else ever is") {
  constexpr int kPictures = 60;
  const cv::Mat floor = floor_of(kPictures, 7);
  cv::Mat letters = cv::Mat::zeros(kSize, CV_8UC1), clean;
  write(letters);
  for (const bool written : {true, false}) {
    for (const bool moves : {true, false}) {
      CAPTURE(written);
      CAPTURE(moves);
      SteadyPattern pattern;
      cv::Mat seen;
      for (int i = 0; i < kPictures; ++i) {
        floor(cv::Rect{cv::Point{moves ? kStep * i : 0, 0}, kSize}).copyTo(seen);
        if (written) write(seen);
        pattern.learn(seen, {moves ? -kStep : 0.0, 0.0});
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

TEST_CASE("steady pattern: a floor that a hovering vehicle sees again and again is none") {
  constexpr int kPictures = 200;
  const cv::Mat floor = floor_of(2, 8);
  SteadyPattern pattern;
  cv::Mat clean;
  for (int i = 0; i < kPictures; ++i) {
    const cv::Mat seen = floor(cv::Rect{cv::Point{kStep * (i % 2), 0}, kSize});
    pattern.learn(seen, {i % 2 == 0 ? kStep : -kStep, 0.0});
    pattern.take_out(seen, clean);
  }
  CHECK_FALSE(pattern.known());
  CHECK(cv::norm(clean, floor(cv::Rect{cv::Point{kStep, 0}, kSize}), cv::NORM_INF) == 0.0);
}

}  // namespace fathom::vision
