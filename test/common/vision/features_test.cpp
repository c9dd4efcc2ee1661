// What is chosen to be followed, against OpenCV's own choice.
#include "common/vision/flow/features.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <opencv2/imgproc.hpp>

namespace fathom::vision {
namespace {

constexpr double kQuality = 0.005, kApart = 11.75;
constexpr int kMost = 200;

cv::Mat texture(std::uint64_t seed, const cv::Size& size) {
  cv::RNG random{seed};
  cv::Mat grey(size, CV_8UC1);
  random.fill(grey, cv::RNG::NORMAL, 100.0, 60.0);
  cv::GaussianBlur(grey, grey, {}, 1.5);
  cv::rectangle(grey, {size.width / 3, size.height / 3, 40, 40}, cv::Scalar{250}, cv::FILLED);
  return grey;
}

}  // namespace

TEST_CASE("features: as OpenCV chooses them, but for ties, with a mask and without") {
  constexpr std::size_t kTies = 4;
  Features features;
  for (const cv::Size& size : {cv::Size{320, 240}, cv::Size{133, 77}, cv::Size{320, 240}}) {
    const cv::Mat grey = texture(3, size);
    cv::Mat half(size, CV_8UC1, cv::Scalar{255});
    half.colRange(0, size.width / 2).setTo(0);
    for (const cv::Mat& mask : {cv::Mat{}, half}) {
      std::vector<cv::Point2f> ours, theirs;
      features.look(grey, mask);
      features.choose(kQuality, kApart, kMost, ours);
      cv::goodFeaturesToTrack(grey, theirs, kMost, kQuality, kApart, mask, 3);
      REQUIRE(theirs.size() > 10);
      CHECK(ours.size() + kTies >= theirs.size());
      CHECK(ours.front() == theirs.front());
      const auto same = std::ranges::count_if(
          ours, [&](const cv::Point2f& each) { return std::ranges::find(theirs, each) != theirs.end(); });
      CHECK(static_cast<std::size_t>(same) + kTies >= theirs.size());
      for (std::size_t i = 0; i < ours.size(); ++i) {
        if (!mask.empty()) CHECK(ours[i].x >= static_cast<float>(size.width) / 2.0F - 1.0F);
        for (std::size_t j = 0; j < i; ++j) CHECK(cv::norm(ours[i] - ours[j]) >= kApart);
      }
    }
  }
}

TEST_CASE("features: none where nothing is to be seen, no more than are wanted, and none in a picture of two pixels") {
  Features features;
  std::vector<cv::Point2f> chosen;
  for (const cv::Mat& grey : {cv::Mat(60, 80, CV_8UC1, cv::Scalar{90}), cv::Mat(2, 2, CV_8UC1, cv::Scalar{90})}) {
    features.look(grey, {});
    features.choose(kQuality, kApart, kMost, chosen);
    CHECK(chosen.empty());
  }
  features.look(texture(4, {320, 240}), {});
  features.choose(kQuality, kApart, 20, chosen);
  CHECK(chosen.size() == 20);
}

}  // namespace fathom::vision
