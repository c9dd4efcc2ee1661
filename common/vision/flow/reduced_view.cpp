#include "common/vision/flow/reduced_view.hpp"

#include <algorithm>

#include "common/base/spatial.hpp"

namespace fathom::vision {
namespace {

constexpr int kApart = 16;      // px between two nodes
constexpr double kAhead = 0.1;  // of a direction's length, along the axis

}  // namespace

Eigen::Matrix3d PlaneMotion::turned(double share) const {
  const Eigen::Vector3d turn = rotation_vector_from_quaternion(Eigen::Quaterniond{R_01});
  return quaternion_from_rotation_vector(share * turn).toRotationMatrix();
}

double PlaneMotion::distance(double share) const {
  return (1.0 - share * n_0.dot(tau)) / n_0.dot(turned(share).col(2));
}

cv::Size ReducedView::size() const {
  const model::Lens& lens = projection_.lens();
  return {cvRound(lens.width / reduction_), cvRound(lens.height / reduction_)};  // as cv::resize
}

Eigen::Vector2d ReducedView::whole(const cv::Point2f& p) const {
  return {(static_cast<double>(p.x) + 0.5) * reduction_ - 0.5, (static_cast<double>(p.y) + 0.5) * reduction_ - 0.5};
}

cv::Point2f ReducedView::reduced(const Eigen::Vector2d& p) const {
  return {static_cast<float>((p.x() + 0.5) / reduction_ - 0.5), static_cast<float>((p.y() + 0.5) / reduction_ - 0.5)};
}

Eigen::Vector3d ReducedView::direction(const cv::Point2f& p) const {
  const Eigen::Vector2d x = projection_.normalized(whole(p));
  return {x.x(), x.y(), 1.0};
}

std::optional<cv::Point2f> ReducedView::pixel(const Eigen::Vector3d& x) const {
  if (!(x.z() > kAhead)) return {};
  return reduced(projection_.pixel(x));
}

void ReducedView::map_origin(const PlaneMotion& motion, const cv::Rect& part, cv::Mat& nodes, cv::Mat& origin) const {
  const cv::Size picture = size();
  nodes.create((picture.height - 1) / kApart + 2, (picture.width - 1) / kApart + 2, CV_32FC2);
  const int left = part.x / kApart, right = (part.x + part.width - 1) / kApart;
  for (int y = part.y / kApart; y <= (part.y + part.height - 1) / kApart + 1; ++y) {
    for (int x = left; x <= right + 1; ++x) {
      const cv::Point2f here{static_cast<float>(kApart * x), static_cast<float>(kApart * y)};
      const cv::Point2f from = pixel(motion.backward(direction(here))).value_or(here);
      nodes.at<cv::Vec2f>(y, x) = {from.x, from.y};
    }
  }
  origin.create(picture, CV_32FC2);
  for (int y = part.y; y < part.y + part.height; ++y) {
    const auto *above = nodes.ptr<cv::Vec2f>(y / kApart), *below = nodes.ptr<cv::Vec2f>(y / kApart + 1);
    const float v = static_cast<float>(y % kApart) / static_cast<float>(kApart);
    auto* to = origin.ptr<cv::Vec2f>(y);
    for (int i = left; i <= right; ++i) {
      const cv::Vec2f start = (1.0F - v) * above[i] + v * below[i];
      const cv::Vec2f step =
          ((1.0F - v) * above[i + 1] + v * below[i + 1] - start) * (1.0F / static_cast<float>(kApart));
      for (int x = i * kApart; x < std::min((i + 1) * kApart, picture.width); ++x)
        to[x] = start + static_cast<float>(x - i * kApart) * step;
    }
  }
}

}  // namespace fathom::vision
