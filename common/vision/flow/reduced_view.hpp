// Pictures made smaller by a whole or broken number, and where a motion over a plane takes their points.
#pragma once

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>
#include <opencv2/core/types.hpp>
#include <optional>

#include "common/vision/projection.hpp"

namespace fathom::vision {

/// A camera's motion between two pictures over a plane, in normalized coordinates: x_1 ~ R_01^T (x_0 - tau n_0^T x_0).
struct PlaneMotion {
  Eigen::Matrix3d R_01;                          ///< axes of the later camera in those of the earlier
  Eigen::Vector3d n_0;                           ///< the plane's normal in the earlier one, scaled so that n_0.z() is 1
  Eigen::Vector3d tau{Eigen::Vector3d::Zero()};  ///< shift in the earlier one's axes, over the distance along its axis

  [[nodiscard]] Eigen::Vector3d forward(const Eigen::Vector3d& x_0) const {
    return R_01.transpose() * (x_0 - tau * n_0.dot(x_0));
  }
  [[nodiscard]] Eigen::Vector3d backward(const Eigen::Vector3d& x_1) const {
    const Eigen::Vector3d turned = R_01 * x_1;
    return turned + tau * (n_0.dot(turned) / (1.0 - n_0.dot(tau)));
  }
  /// Axes of the camera after a share of the turn, in those of the earlier one.
  [[nodiscard]] Eigen::Matrix3d turned(double share) const;
  /// The distance to the plane along the camera's axis after a share of the motion, over that before: along an aslant
  /// axis it changes with a shift along the plane, and with a turn.
  [[nodiscard]] double distance(double share) const;
};

class ReducedView {
 public:
  ReducedView(const model::Lens& lens, double reduction) : projection_{lens}, reduction_{reduction} {}

  [[nodiscard]] const Projection& projection() const { return projection_; }
  [[nodiscard]] cv::Size size() const;
  [[nodiscard]] double focal() const { return projection_.lens().focal() / reduction_; }  ///< px, reduced
  /// Pixels of the reduced picture and of the whole one: pixels' middles are whole numbers in both.
  [[nodiscard]] Eigen::Vector2d whole(const cv::Point2f& p) const;
  [[nodiscard]] cv::Point2f reduced(const Eigen::Vector2d& p) const;
  /// (x, y, 1) of where a pixel looks.
  [[nodiscard]] Eigen::Vector3d direction(const cv::Point2f& p) const;
  /// Nothing for what lies at the camera's side or behind it.
  [[nodiscard]] std::optional<cv::Point2f> pixel(const Eigen::Vector3d& x) const;

  /// For each pixel of a part of the later picture, where its point of the plane was in the earlier one: `origin`,
  /// CV_32FC2, of the whole picture's size.
  /// `nodes` is scratch: between its nodes, sixteen pixels apart, a lens is smooth.
  void map_origin(const PlaneMotion& motion, const cv::Rect& part, cv::Mat& nodes, cv::Mat& origin) const;

 private:
  Projection projection_;
  double reduction_;
};

}  // namespace fathom::vision
