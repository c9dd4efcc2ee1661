#include "common/vision/light_change.hpp"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <array>
#include <cmath>

namespace fathom::vision {
namespace {

constexpr int kHalf = 7, kSide = 2 * kHalf + 1;  // of the window: Lucas-Kanade's
constexpr int kUnknown = 6;
constexpr int kRounds = 2;
constexpr float kFarthest = 0.5F;  // px
constexpr float kLeast = 50.0F;    // texture, square of brightness per px, over the window, beside light

template <int Size>
using Window = std::array<float, static_cast<std::size_t>(Size* Size)>;

// A square of the picture, its middle between pixels; false when it is not all within.
template <int Size>
bool cut(const cv::Mat& picture, const cv::Point2f& middle, Window<Size>& to) {
  constexpr int kReach = Size / 2;
  const float left = middle.x - static_cast<float>(kReach), top = middle.y - static_cast<float>(kReach);
  const int x0 = static_cast<int>(std::floor(left)), y0 = static_cast<int>(std::floor(top));
  if (x0 < 0 || y0 < 0 || x0 + Size >= picture.cols || y0 + Size >= picture.rows) return false;
  const float u = left - static_cast<float>(x0), v = top - static_cast<float>(y0);
  const float a = (1 - u) * (1 - v), b = u * (1 - v), c = (1 - u) * v, d = u * v;
  float* out = to.data();
  for (int y = 0; y < Size; ++y) {
    const std::uint8_t* row = picture.ptr<std::uint8_t>(y0 + y) + x0;
    const std::uint8_t* next = picture.ptr<std::uint8_t>(y0 + y + 1) + x0;
    for (int x = 0; x < Size; ++x) {
      *out++ = a * static_cast<float>(row[x]) + b * static_cast<float>(row[x + 1]) + c * static_cast<float>(next[x]) +
               d * static_cast<float>(next[x + 1]);
    }
  }
  return true;
}

}  // namespace

std::optional<cv::Point2f> end_in_changed_light(const cv::Mat& before, const cv::Mat& now, const cv::Point2f& from,
                                                const cv::Point2f& to) {
  constexpr int kWide = kSide + 2;
  Window<kWide> wide;
  if (!cut<kWide>(before, from, wide)) return {};
  // Columns: the slopes; then the light: brightness less its mean, one, and where in the window.
  static constexpr int kPixels = kSide * kSide;
  Eigen::Matrix<float, kPixels, kUnknown> by;
  Eigen::Matrix<float, kPixels, 1> first;
  for (int y = 0, i = 0; y < kSide; ++y) {
    for (int x = 0; x < kSide; ++x, ++i) {
      const float* at = wide.data() + (y + 1) * kWide + x + 1;
      first[i] = *at;
      by(i, 0) = 0.5F * (at[1] - at[-1]);
      by(i, 1) = 0.5F * (at[kWide] - at[-kWide]);
      by(i, 4) = static_cast<float>(x - kHalf);
      by(i, 5) = static_cast<float>(y - kHalf);
    }
  }
  by.col(2) = first.array() - first.mean();
  by.col(3).setOnes();
  const Eigen::Matrix<float, kUnknown, kUnknown> information = by.transpose() * by;
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
    if (!cut<kSide>(now, end, seen)) return {};
    const Eigen::Map<const Eigen::Matrix<float, kPixels, 1>> second{seen.data()};
    const Eigen::Matrix<float, kUnknown, 1> step = solver.solve(by.transpose() * (second - first));
    end.x -= step[0];
    end.y -= step[1];
  }
  const cv::Point2f moved = end - to;
  if (!(std::hypot(moved.x, moved.y) < kFarthest)) return {};
  return end;
}

}  // namespace fathom::vision
