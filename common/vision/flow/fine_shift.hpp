// How a picture's fine detail has moved as a whole. Light that waves focus on the floor is smooth: the sun is 7 mrad
// wide under water, four pixels and more of a camera with 540 px of focal length. What is finer is the floor's. So
// phases alone are correlated (Kuglin and Hines 1975), each frequency of a band with the same weight, however bright
// what moves over it.
#pragma once

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>
#include <opencv2/core/types.hpp>
#include <optional>

namespace fathom::vision {

struct FineMotion {
  Eigen::Vector2d shift{Eigen::Vector2d::Zero()};  ///< px, of this picture against where it was expected
  double strength{};                               ///< height of the peak over the spread of all others
};

class FineShift {
 public:
  /// The next picture, 8 bits, grey; the last one becomes the one before. `weight`: of each pixel's detail, smooth,
  /// CV_32FC1; empty: all alike.
  void look(const cv::Mat& grey, const cv::Mat& weight = {});
  /// What brightness differs by from its surroundings, in this picture and in the one before: of its logarithm, times
  /// the picture's mean brightness. CV_32FC1.
  [[nodiscard]] const cv::Mat& detail() const { return detail_; }
  [[nodiscard]] const cv::Mat& detail_before() const { return detail_before_; }
  /// What of a picture is looked at: its middle. Nothing before the first.
  [[nodiscard]] const cv::Rect& part() const { return part_; }
  /// `origin` (CV_32FC2): for each pixel of that part, in a map of the whole, where in the picture before the same
  /// point is expected. Nothing when there is no picture before, or nothing that has moved as one. What moves with the
  /// camera (dirt on its window, a dot, a coder's blocks) may be stronger than the floor: where the floor is expected
  /// elsewhere, a peak there is enough, and one that is half as strong anywhere. Without either the floor rests, if
  /// what is steady in pictures is known.
  [[nodiscard]] std::optional<FineMotion> find(const cv::Mat& origin, bool steady_known = false);

 private:
  void prepare(cv::Size size);
  void correlate(const cv::Mat& origin);
  [[nodiscard]] float value(cv::Point at) const;
  [[nodiscard]] FineMotion peak(cv::Point at) const;
  [[nodiscard]] FineMotion highest() const;
  [[nodiscard]] FineMotion highest_near(cv::Point place, int reach) const;
  void take_out_near(cv::Point place, int reach);
  void transform(const cv::Mat& from, cv::Mat& to);

  cv::Size size_;
  cv::Rect part_;
  cv::Mat detail_, detail_before_, now_, before_;  // the last two with the same contrast in every region
  cv::Mat window_, band_;
  double chance_{};  ///< spread of the peaks were all phases chance
  cv::Mat surroundings_, squares_, contrast_, expected_, tapered_, spectrum_now_, spectrum_before_, product_, peaks_;
};

}  // namespace fathom::vision
