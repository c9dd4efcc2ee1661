// A bright spot's middle against where it was drawn.
#include "common/vision/laser/bright_spot.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <opencv2/core.hpp>

namespace fathom::vision {
namespace {

constexpr double kWindow = 2.25, kReach = 2.5;  // px

cv::Mat drawn(const Eigen::Vector2d& at, double size, double height, double floor) {
  cv::Mat grey(60, 80, CV_8UC1);
  for (int y = 0; y < grey.rows; ++y) {
    for (int x = 0; x < grey.cols; ++x) {
      const double r2 = (Eigen::Vector2d{x, y} - at).squaredNorm();
      grey.at<std::uint8_t>(y, x) =
          cv::saturate_cast<std::uint8_t>(floor + height * std::exp(-0.5 * r2 / (size * size)));
    }
  }
  return grey;
}

}  // namespace

TEST_CASE("bright spot: small and large, saturated too, found where it was drawn, from any pixel nearby") {
  constexpr double kExact = 0.06;  // px: whole steps of brightness, and where a round ends
  for (const double size : {0.7, 1.2, 2.0, 4.0}) {
    for (const double height : {60.0, 400.0}) {
      for (int i = 0; i < 10; ++i) {
        const Eigen::Vector2d at{40.0 + 0.1 * i, 30.0 - 0.07 * i};
        CAPTURE(size);
        CAPTURE(height);
        CAPTURE(i);
        const auto spot = find_bright_spot(drawn(at, size, height, 50.0), {41.0, 30.0}, kWindow, kReach);
        REQUIRE(spot);
        CHECK((spot->pixel - at).norm() < kExact);
        CHECK(spot->height > 0.0);
      }
    }
  }
}

TEST_CASE("bright spot: an edge beside it moves it by no more than a few times what it says") {
  for (int i = 0; i < 12; ++i) {
    const Eigen::Vector2d at{40.0, 30.0};
    cv::Mat grey = drawn(at, 1.2, 120.0, 50.0);
    const int edge = 42 + i;
    for (int y = 0; y < grey.rows; ++y) {
      for (int x = edge; x < grey.cols; ++x)
        grey.at<std::uint8_t>(y, x) = cv::saturate_cast<std::uint8_t>(grey.at<std::uint8_t>(y, x) + 60);
    }
    CAPTURE(edge);
    const auto spot = find_bright_spot(grey, at, kWindow, kReach);
    if (spot) CHECK((spot->pixel - at).norm() < 3.0 * spot->sigma + 0.06);
  }
}

TEST_CASE("bright spot: none in an even, a dark or a sloping place, nor at the border") {
  const cv::Mat even(60, 80, CV_8UC1, cv::Scalar{90});
  CHECK_FALSE(find_bright_spot(even, {40, 30}, kWindow, kReach));
  CHECK_FALSE(find_bright_spot(255 - drawn({40, 30}, 1.5, 100, 50), {40, 30}, kWindow, kReach));
  cv::Mat slope(60, 80, CV_8UC1);
  for (int y = 0; y < 60; ++y) {
    for (int x = 0; x < 80; ++x) slope.at<std::uint8_t>(y, x) = static_cast<std::uint8_t>(3 * x);
  }
  CHECK_FALSE(find_bright_spot(slope, {40, 30}, kWindow, kReach));
  CHECK_FALSE(find_bright_spot(drawn({4, 30}, 1.2, 100, 50), {4, 30}, kWindow, kReach));
}

}  // namespace fathom::vision
