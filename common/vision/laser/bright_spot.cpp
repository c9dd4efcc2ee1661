#include "common/vision/laser/bright_spot.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace fathom::vision {
namespace {

constexpr int kRing = 40;        // places around the spot
constexpr double kRingAt = 4.0;  // windows from the middle: what is left of the spot there is below 1 / 1000
constexpr int kRounds = 20;
constexpr double kStride = 1.5;  // steps: small spots show all of how far the window is off, large ones less than half
constexpr double kSettled = 0.01;  // px

struct Level {
  double median{}, spread{};
};

Level around(const cv::Mat& grey, int u, int v, double radius) {
  std::array<double, kRing> values{};
  for (int k = 0; k < kRing; ++k) {
    const double angle = k * 2.0 * M_PI / kRing;
    values[static_cast<std::size_t>(k)] =
        grey.at<std::uint8_t>(v + static_cast<int>(std::lround(radius * std::sin(angle))),
                              u + static_cast<int>(std::lround(radius * std::cos(angle))));
  }
  std::nth_element(values.begin(), values.begin() + kRing / 2, values.end());
  Level level{.median = values[kRing / 2]};
  for (const double value : values) level.spread += (value - level.median) * (value - level.median) / kRing;
  level.spread = std::sqrt(level.spread);
  return level;
}

}  // namespace

std::optional<BrightSpot> find_bright_spot(const cv::Mat& grey, const Eigen::Vector2d& start, double window,
                                           double reach) {
  const int side = static_cast<int>(std::ceil(kRingAt * window)) + 1;
  BrightSpot spot{.pixel = start};
  for (int round = 0; round < kRounds; ++round) {
    const int u = static_cast<int>(std::lround(spot.pixel.x())), v = static_cast<int>(std::lround(spot.pixel.y()));
    if (u < side || v < side || u >= grey.cols - side || v >= grey.rows - side) return {};
    const Level level = around(grey, u, v, kRingAt * window);
    double sum = 0.0, area = 0.0, lever = 0.0;
    Eigen::Vector2d moment = Eigen::Vector2d::Zero();
    for (int y = v - side; y <= v + side; ++y) {
      const std::uint8_t* row = grey.ptr<std::uint8_t>(y);
      for (int x = u - side; x <= u + side; ++x) {
        const Eigen::Vector2d from = Eigen::Vector2d{x, y} - spot.pixel;
        const double weight = std::exp(-0.5 * from.squaredNorm() / (window * window));
        sum += weight * (row[x] - level.median);
        moment += weight * (row[x] - level.median) * from;
        area += weight;
        lever += weight * std::abs(from.x());
      }
    }
    if (sum <= 0.0) return {};
    const Eigen::Vector2d step = kStride * moment / sum;
    spot.pixel += step;
    spot.height = sum / area;
    // The worst that surroundings of this spread can do is an edge through the middle.
    spot.sigma = level.spread * lever / sum;
    if ((spot.pixel - start).norm() > reach) return {};
    if (step.norm() < kSettled) return spot;
  }
  return {};
}

}  // namespace fathom::vision
