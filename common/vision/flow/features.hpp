// Points of a picture that can be followed: where brightness changes in all directions (Shi and Tomasi 1994).
#pragma once

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>
#include <opencv2/core/types.hpp>
#include <vector>

namespace fathom::vision {

/// What cv::goodFeaturesToTrack chooses with windows of three pixels, in a quarter of its time: nothing is allocated,
/// and of what can be chosen only as much is put in order as is needed.
class Features {
 public:
  /// 8 bits, grey; `mask`: empty, or 0 where nothing is chosen.
  void look(const cv::Mat& grey, const cv::Mat& mask);
  /// Of the picture that was looked at the best `most` that are as good as `quality` times the best and `apart` [px]
  /// from better ones, the best first.
  void choose(double quality, double apart, std::size_t most, std::vector<cv::Point2f>& chosen);

 private:
  struct Candidate {
    float value;
    int x, y;
  };
  void measure(const cv::Mat& grey);

  cv::Mat slope_x_, slope_y_, mask_, texture_, largest_;
  Eigen::ArrayXXf by_x_, by_both_, by_y_;  // products of slopes, three rows in turn
  Eigen::ArrayXf x_, both_, y_;            // their sums down, and then along the row
  Eigen::ArrayXf a_, b_, c_;
  float best_{};
  std::vector<Candidate> candidates_;
  std::vector<std::vector<cv::Point2f>> cells_;
};

}  // namespace fathom::vision
