#include "common/vision/flow/light_change.hpp"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <cmath>

namespace fathom::vision {
namespace {

constexpr int kHalf = 7, kSide = 2 * kHalf + 1;  // of the window: Lucas-Kanade's
constexpr int kUnknown = 6;
constexpr int kRounds = 2;
constexpr float kFarthest = 0.5F;  // px
constexpr float kLeast = 5.0F;     // texture, square of brightness per px, over the window, beside light

/// A square of brightness, a column per row of the picture.
template <int Size>
using Window = Eigen::Matrix<float, Size, Size>;
template <int Size>
using Row = Eigen::Map<const Eigen::Matrix<float, Size, 1>>;

// A square of the picture, its middle between pixels; false when it is not all within.
template <int Size>
bool cut(const cv::Mat& picture, const cv::Point2f& middle, Window<Size>& to) {
  constexpr int kReach = Size / 2;
  const float left = middle.x - static_cast<float>(kReach), top = middle.y - static_cast<float>(kReach);
  const int x0 = static_cast<int>(std::floor(left)), y0 = static_cast<int>(std::floor(top));
  if (x0 < 0 || y0 < 0 || x0 + Size >= picture.cols || y0 + Size >= picture.rows) return false;
  const float u = left - static_cast<float>(x0), v = top - static_cast<float>(y0);
  const float a = (1 - u) * (1 - v), b = u * (1 - v), c = (1 - u) * v, d = u * v;
  for (int y = 0; y < Size; ++y) {
    const float* row = picture.ptr<float>(y0 + y) + x0;
    const float* next = picture.ptr<float>(y0 + y + 1) + x0;
    to.col(y) = a * Row<Size>{row} + b * Row<Size>{row + 1} + c * Row<Size>{next} + d * Row<Size>{next + 1};
  }
  return true;
}

constexpr int kPixels = kSide * kSide;
using Columns = Eigen::Matrix<float, kPixels, kUnknown>;

// One, and where in the window: the last three columns, the same in every window. Before them the slopes, and
// brightness less its mean.
Eigen::Matrix<float, kPixels, 3> positions() {
  Eigen::Matrix<float, kPixels, 3> last;
  last.col(0).setOnes();
  for (int y = 0, i = 0; y < kSide; ++y) {
    for (int x = 0; x < kSide; ++x, ++i) {
      last(i, 1) = static_cast<float>(x - kHalf);
      last(i, 2) = static_cast<float>(y - kHalf);
    }
  }
  return last;
}

// by^T by, each product once.
Eigen::Matrix<float, kUnknown, kUnknown> products(const Columns& by) {
  Eigen::Matrix<float, kUnknown, kUnknown> sums = Eigen::Matrix<float, kUnknown, kUnknown>::Zero();
  for (int j = 0; j < 3; ++j) {
    for (int i = j; i < kUnknown; ++i) sums(i, j) = sums(j, i) = by.col(i).dot(by.col(j));
  }
  // Of one and places, whose middle is 0.
  constexpr int kSquares = kSide * kHalf * (kHalf + 1) * kSide / 3;  // of places along one side
  sums.diagonal().tail<3>() << static_cast<float>(kPixels), static_cast<float>(kSquares), static_cast<float>(kSquares);
  return sums;
}

}  // namespace

std::optional<TrackEnd> end_in_changed_light(const cv::Mat& before, const cv::Mat& now, const cv::Point2f& from,
                                             const cv::Point2f& to) {
  constexpr int kWide = kSide + 2;
  Window<kWide> wide;
  if (!cut<kWide>(before, from, wide)) return {};
  static const Eigen::Matrix<float, kPixels, 3> kPositions = positions();
  Columns by;
  by.rightCols<3>() = kPositions;
  const auto column = [&](int i) { return Eigen::Map<Window<kSide>>{by.col(i).data()}; };
  const auto part = [&](int x, int y) { return wide.block<kSide, kSide>(1 + x, 1 + y); };
  column(0) = 0.5F * (part(1, 0) - part(-1, 0));
  column(1) = 0.5F * (part(0, 1) - part(0, -1));
  const Window<kSide> first = part(0, 0);
  column(2) = first.array() - first.mean();
  const Eigen::Matrix<float, kUnknown, kUnknown> information = products(by);
  const Eigen::LDLT<Eigen::Matrix<float, kUnknown, kUnknown>> solver{information};
  const Eigen::Matrix4f light = information.bottomRightCorner<4, 4>() + 1e-3F * Eigen::Matrix4f::Identity();
  const Eigen::Matrix2f texture =
      information.topLeftCorner<2, 2>() -
      information.topRightCorner<2, 4>() * light.ldlt().solve(information.bottomLeftCorner<4, 2>());
  const float half_trace = 0.5F * texture.trace();
  const float weakest = half_trace - std::sqrt(std::max(half_trace * half_trace - texture.determinant(), 0.0F));
  if (!(weakest > kLeast)) return {};
  cv::Point2f end = to;
  Window<kSide> seen;
  for (int round = 0; round < kRounds; ++round) {
    if (!cut<kSide>(now, end, seen)) return round == 0 ? std::nullopt : std::optional{TrackEnd{.at = end}};
    const Window<kSide> changed = seen - first;
    const Eigen::Map<const Eigen::Matrix<float, kPixels, 1>> change{changed.data()};
    const Eigen::Matrix<float, kUnknown, 1> step = solver.solve(by.transpose() * change);
    end.x -= step[0];
    end.y -= step[1];
  }
  const cv::Point2f moved = end - to;
  return TrackEnd{.at = end, .near = std::hypot(moved.x, moved.y) < kFarthest};
}

// A normal distribution in the plane of which only what lies within R of a place is kept: with k = R^2 / (2 sigma^2)
// the mean of that moves by g = 1 - k / (e^k - 1) of what the whole's does, and its variance is g sigma^2. With s that
// variance over the one of an even disc, R^2 / 4, g is 1 - s^3 to within 0.03.
double share_seen_near(double spread) {
  const double share = std::pow(2.0 * spread / static_cast<double>(kFarthest), 2);
  return 1.0 - share * share * share;
}

}  // namespace fathom::vision
