// What stays where it is in the picture while the floor moves: dirt on the window, letters that a camera writes, bad
// pixels. Tracked, it says that the vehicle rests. It multiplies light, so its logarithm is the mean of the pictures'
// over many pieces of floor, and is taken out.
#pragma once

#include <Eigen/Core>
#include <deque>
#include <opencv2/core/mat.hpp>

namespace fathom::vision {

class SteadyPattern {
 public:
  /// `grey`: 8 bits; `clean`: the same without what is known to be steady.
  void take_out(const cv::Mat& grey, cv::Mat& clean);
  /// The floor has moved by so much [px] since the picture before, to where it is in `grey`, which still has the
  /// pattern. Learnt from are pictures of floor that none of the last hundred has shown.
  void learn(const cv::Mat& grey, const Eigen::Vector2d& moved);
  /// Enough has been learnt to say what is steady, or that nothing is.
  [[nodiscard]] bool known() const;

 private:
  void judge();

  Eigen::Vector2d at_{Eigen::Vector2d::Zero()};  ///< px that the floor has moved, as far as it was told
  std::deque<Eigen::Vector2d> places_;           ///< of the pictures that were learnt from
  cv::Mat mean_;                                 ///< of the logarithm's fine detail
  double spread_{};
  int n_{}, since_{};
  bool any_{};
  cv::Mat gain_, detail_, blurred_;
};

}  // namespace fathom::vision
