#include "common/vision/flow/flow_pictures.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <opencv2/video/tracking.hpp>

namespace fathom::vision {
namespace {

constexpr int kLevels = 3;
constexpr double kSmooth = 1.0, kWide = 2.0;  // px, reduced

cv::Size window(double reduction) {
  const int side = reduction > 1.5 ? 15 : 21;
  return {side, side};
}

}  // namespace

cv::Mat FlowPictures::leave_out(const cv::Mat& apart) {
  constexpr float kSpread = 5.0F, kFade = 25.0F;  // px: as far as smoothing spreads a dot
  if (weight_.empty()) weight_ = cv::Mat(apart.size(), CV_32FC1, cv::Scalar{1.0});
  // Detail fades out: where it ended all at once, the end itself, which rests, would be detail.
  for (int y = 0; y < apart.rows; ++y) {
    for (int x = 0; x < apart.cols; ++x) {
      const float share = std::clamp((apart.at<float>(y, x) - kSpread) / kFade, 0.0F, 1.0F);
      weight_.at<float>(y, x) *= share * share * (3.0F - 2.0F * share);
    }
  }
  return apart > kSpread + 0.5F * static_cast<float>(window(reduction_).width);
}

void FlowPictures::look(const cv::Mat& grey) {
  if (reduction_ > 1.0) {
    cv::resize(grey, seen_, {}, 1.0 / reduction_, 1.0 / reduction_, cv::INTER_AREA);
  } else {
    grey.copyTo(seen_);
  }
  steady_.take_out(seen_, small_);
  std::swap(pyramid_, pyramid_before_);
  cv::buildOpticalFlowPyramid(small_, pyramid_, window(reduction_), kLevels);
  // Mean values of pixels still hold detail finer than the reduced ones can: interpolated, it draws each feature to
  // whole pixels, and motion of less than one, as a divergence is, was read too small. Tracks' ends are fitted in
  // smoother pictures; not found in them, for moving light is smooth too: so what is coarser is taken out.
  cv::GaussianBlur(small_, blurred_, {5, 5}, kSmooth);
  blurred_.convertTo(smooth_, CV_32F);
  std::swap(fine_, fine_before_);
  take_out_coarser(fine_);
  shift_.look(small_, weight_);
}

void FlowPictures::take_out_coarser(cv::Mat& to) {
  cv::GaussianBlur(smooth_, wide_, {13, 13}, kWide);
  cv::subtract(smooth_, wide_, to);
}

FlowPictures::Pair FlowPictures::finer() {
  cv::GaussianBlur(shift_.detail_before(), smooth_, {5, 5}, kSmooth);
  take_out_coarser(finer_before_);
  cv::GaussianBlur(shift_.detail(), smooth_, {5, 5}, kSmooth);
  take_out_coarser(finer_);
  return {finer_before_, finer_};
}

void FlowPictures::follow(const std::vector<cv::Point2f>& features, double most, std::vector<cv::Point2f>& found,
                          std::vector<unsigned char>& ok) {
  const cv::TermCriteria stop{cv::TermCriteria::COUNT | cv::TermCriteria::EPS, 8, 0.03};
  constexpr double kWeakest = 5e-4;
  const cv::Size around = window(reduction_);
  cv::calcOpticalFlowPyrLK(pyramid_before_, pyramid_, features, found, ok, errors_, around, kLevels, stop,
                           cv::OPTFLOW_USE_INITIAL_FLOW, kWeakest);
  back_ = features;
  cv::calcOpticalFlowPyrLK(pyramid_, pyramid_before_, found, back_, ok_back_, errors_, around, 0, stop,
                           cv::OPTFLOW_USE_INITIAL_FLOW, kWeakest);
  const auto right = static_cast<float>(small_.cols - 1), bottom = static_cast<float>(small_.rows - 1);
  for (std::size_t i = 0; i < features.size(); ++i) {
    const cv::Point2f miss = back_[i] - features[i];
    const bool inside = found[i].x >= 0 && found[i].y >= 0 && found[i].x <= right && found[i].y <= bottom;
    if (ok_back_[i] == 0 || !inside || std::hypot(miss.x, miss.y) > static_cast<float>(most)) ok[i] = 0;
  }
}

}  // namespace fathom::vision
