// Two pictures, one after the other, as optical flow looks at them: made smaller; in pyramids, to follow features from
// one to the other; and their fine detail alone, to fit features' ends in.
#pragma once

#include <opencv2/core/mat.hpp>
#include <opencv2/core/types.hpp>
#include <optional>
#include <vector>

#include "common/vision/flow/fine_shift.hpp"
#include "common/vision/flow/steady_pattern.hpp"

namespace fathom::vision {

class FlowPictures {
 public:
  /// Earlier and later picture, CV_32FC1.
  struct Pair {
    const cv::Mat &before, &now;
  };

  explicit FlowPictures(double reduction) : reduction_{reduction} {}

  /// `apart` (CV_32FC1): each pixel's distance [px] from what moves with the camera. Fine detail is left out there.
  /// Returns where features may be, 0 elsewhere: their windows would see it rest.
  cv::Mat leave_out(const cv::Mat& apart);
  /// The next picture, 8 bits, grey; the last one becomes the one before.
  void look(const cv::Mat& grey);
  [[nodiscard]] const cv::Mat& small() const { return small_; }
  /// Lucas-Kanade from `features` to `found`, which says where to begin, and back; `ok` is 0 for those that were not
  /// found, or missed their beginning by more than `most` [px].
  void follow(const std::vector<cv::Point2f>& features, double most, std::vector<cv::Point2f>& found,
              std::vector<unsigned char>& ok);
  /// As FineShift's.
  [[nodiscard]] const cv::Rect& part() const { return shift_.part(); }
  [[nodiscard]] std::optional<FineMotion> find_shift(const cv::Mat& origin) {
    return shift_.find(origin, steady_.known());
  }
  /// The floor has moved by so much [px] from the picture before to this one: what has not is known by and by.
  void learn_steady(const Eigen::Vector2d& moved) { steady_.learn(seen_, moved); }
  /// Detail between a pixel and some.
  [[nodiscard]] Pair fine() const { return {fine_before_, fine_}; }
  /// Such detail of brightness against its surroundings: less is left of light, which multiplies and is coarser, and of
  /// a floor that has little of that fineness, too.
  [[nodiscard]] Pair finer();

 private:
  void take_out_coarser(cv::Mat& to);

  double reduction_;
  cv::Mat seen_, small_;  // as it is, and without what is steady
  cv::Mat weight_;        // of fine detail; empty: all alike
  SteadyPattern steady_;
  std::vector<cv::Mat> pyramid_, pyramid_before_;
  FineShift shift_;
  cv::Mat blurred_;
  cv::Mat smooth_, wide_, fine_, fine_before_, finer_, finer_before_;
  std::vector<cv::Point2f> back_;
  std::vector<unsigned char> ok_back_;
  std::vector<float> errors_;
};

}  // namespace fathom::vision
