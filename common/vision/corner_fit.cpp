#include "common/vision/corner_fit.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <optional>

namespace fathom::vision {
namespace {

constexpr int kRounds = 3;          // each centres the window on the line of the one before: no pull to one side
constexpr int kMostSamples = 32;    // along an edge
constexpr double kFree = 0.12;      // share of the edge next to each corner, where the other edge shows
constexpr double kStep = 0.5;       // px along the normal
constexpr double kFarthest = 0.9;   // px that a corner may move: further off lies another edge
constexpr double kLeastRise = 3.0;  // brightness across the edge that counts as one
constexpr double kLeastNet = 0.3;   // share of all rises that remains from one side to the other: noise has none

/// A line as a point and a unit direction.
struct Line {
  Eigen::Vector2d point, direction;
};

double sample(const cv::Mat& grey, double x, double y) {
  const int x0 = static_cast<int>(x), y0 = static_cast<int>(y);
  const double fx = x - x0, fy = y - y0;
  const std::uint8_t* row = grey.ptr<std::uint8_t>(y0) + x0;
  const std::uint8_t* next = grey.ptr<std::uint8_t>(y0 + 1) + x0;
  return (1.0 - fy) * ((1.0 - fx) * row[0] + fx * row[1]) + fy * ((1.0 - fx) * next[0] + fx * next[1]);
}

bool inside(const cv::Mat& grey, const Eigen::Vector2d& p) {
  return p.x() >= 0.0 && p.y() >= 0.0 && p.x() < grey.cols - 1 && p.y() < grey.rows - 1;
}

// Where along the normal the brightness changes fastest: mean of the place, weighted by the change in the right sense.
std::optional<double> step_along(const cv::Mat& grey, const Eigen::Vector2d& at, const Eigen::Vector2d& outward,
                                 double reach, double sense) {
  if (!inside(grey, at - (reach + kStep) * outward) || !inside(grey, at + (reach + kStep) * outward)) return {};
  double weight = 0.0, sum = 0.0;
  const int n = static_cast<int>(std::lround(reach / kStep));
  Eigen::Vector2d p = at - (n + 0.5) * kStep * outward;
  double before = sample(grey, p.x(), p.y()), net = 0.0;
  for (int i = -n; i <= n; ++i) {
    p += kStep * outward;
    const double now = sample(grey, p.x(), p.y());
    const double rise = sense * (now - before);
    before = now;
    net += rise;
    if (rise <= 0.0) continue;
    weight += rise;
    sum += rise * i * kStep;
  }
  if (weight < kLeastRise || net < kLeastNet * weight) return {};
  return sum / weight;
}

// Line through the points with weights; twice, the second time without those that lie off.
std::optional<Line> fit(const std::array<Eigen::Vector2d, kMostSamples>& points, int n) {
  constexpr double kOff = 0.6;  // px
  Line line{};
  std::array<bool, kMostSamples> good{};
  good.fill(true);
  for (int round = 0; round < 2; ++round) {
    Eigen::Vector2d mean = Eigen::Vector2d::Zero();
    int used = 0;
    for (int i = 0; i < n; ++i) {
      if (!good[static_cast<std::size_t>(i)]) continue;
      mean += points[static_cast<std::size_t>(i)];
      ++used;
    }
    if (used < 4 || 2 * used < n) return {};
    mean /= used;
    double xx = 0.0, xy = 0.0, yy = 0.0;
    for (int i = 0; i < n; ++i) {
      if (!good[static_cast<std::size_t>(i)]) continue;
      const Eigen::Vector2d d = points[static_cast<std::size_t>(i)] - mean;
      xx += d.x() * d.x();
      xy += d.x() * d.y();
      yy += d.y() * d.y();
    }
    const double angle = 0.5 * std::atan2(2.0 * xy, xx - yy);
    line = {mean, {std::cos(angle), std::sin(angle)}};
    const Eigen::Vector2d normal{-line.direction.y(), line.direction.x()};
    for (int i = 0; i < n; ++i) {
      good[static_cast<std::size_t>(i)] = std::abs(normal.dot(points[static_cast<std::size_t>(i)] - mean)) < kOff;
    }
  }
  return line;
}

/// By how much the lens bends an edge away from its chord [px, outward], as a polynomial that is 0 at both ends.
struct Bow {
  double quarter{}, middle{}, three_quarters{};

  [[nodiscard]] double at(double share) const {  // through the five points (Lagrange)
    const double s = share;
    return s * (1.0 - s) *
           (128.0 / 3.0 * quarter * (0.5 - s) * (0.75 - s) - 64.0 * middle * (0.25 - s) * (0.75 - s) +
            128.0 / 3.0 * three_quarters * (0.25 - s) * (0.5 - s));
  }
  [[nodiscard]] double largest() const {
    return std::max({std::abs(quarter), std::abs(middle), std::abs(three_quarters)});
  }
};

// What is straight in space is straight in normalized coordinates.
Bow bow_of(const Projection* lens, const Eigen::Vector2d& from, const Eigen::Vector2d& to,
           const Eigen::Vector2d& outward) {
  constexpr double kStraight = 0.02;  // px
  constexpr double kSteepest = 20.0;  // tangent of the angle to the axis: there it folds back
  if (lens == nullptr) return {};
  const Eigen::Vector2d a = lens->normalized(from), b = lens->normalized(to);
  if (!(a.norm() < kSteepest) || !(b.norm() < kSteepest)) return {};
  const Eigen::Vector2d along = (to - from).normalized();
  constexpr double kFar = 1e3;  // m: there a port's offset of the rays, which `normalized` neglects, is nothing
  // At a share of the chord in the picture, which is not that in space.
  const auto bend = [&](double share) {
    double s = share, off = 0.0;
    for (int round = 0; round < 2; ++round) {
      const Eigen::Vector2d p = lens->pixel(kFar * Eigen::Vector2d{a + s * (b - a)}.homogeneous()) - from;
      s += share - along.dot(p) / (to - from).norm();
      off = outward.dot(p);
    }
    return off;
  };
  const double middle = bend(0.5);
  if (std::abs(middle) < kStraight) return {};
  return {.quarter = bend(0.25), .middle = middle, .three_quarters = bend(0.75)};
}

/// An edge as it was fitted: its chord.
struct Edge {
  std::optional<Line> line;
  double bow{};  // px
};

Edge fit_edge(const cv::Mat& grey, const Projection* lens, const Eigen::Vector2d& from, const Eigen::Vector2d& to,
              const Eigen::Vector2d& middle, double reach, double sense) {
  const Eigen::Vector2d along = to - from;
  Eigen::Vector2d outward{-along.y(), along.x()};
  outward.normalize();
  if (outward.dot(0.5 * (from + to) - middle) < 0.0) outward = -outward;
  const Bow bow = bow_of(lens, from, to, outward);
  Edge edge{.bow = bow.largest()};
  const int wanted = std::clamp(static_cast<int>(along.norm() * (1.0 - 2.0 * kFree)), 6, kMostSamples);
  std::array<Eigen::Vector2d, kMostSamples> points;
  int n = 0;
  for (int i = 0; i < wanted; ++i) {
    const double share = kFree + (1.0 - 2.0 * kFree) * (i + 0.5) / wanted;
    const Eigen::Vector2d at = from + share * along;
    const auto offset = step_along(grey, at + bow.at(share) * outward, outward, reach, sense);
    if (offset) points[static_cast<std::size_t>(n++)] = at + *offset * outward;
  }
  if (2 * n >= wanted) edge.line = fit(points, n);
  return edge;
}

std::optional<Eigen::Vector2d> meeting(const Line& a, const Line& b) {
  const double cross = a.direction.x() * b.direction.y() - a.direction.y() * b.direction.x();
  if (std::abs(cross) < 0.1) return {};  // nearly parallel: no corner
  const Eigen::Vector2d d = b.point - a.point;
  return a.point + (d.x() * b.direction.y() - d.y() * b.direction.x()) / cross * a.direction;
}

}  // namespace

std::array<bool, 4> fit_corners(const cv::Mat& grey, bool reversed, const Projection* lens,
                                std::array<Eigen::Vector2d, 4>& corners) {
  const std::array<Eigen::Vector2d, 4> begin = corners;
  const double sense = reversed ? -1.0 : 1.0;
  std::array<bool, 4> fitted{};
  for (int round = 0; round < kRounds; ++round) {
    const Eigen::Vector2d middle = 0.25 * (corners[0] + corners[1] + corners[2] + corners[3]);
    double shortest = 1e9;
    for (std::size_t i = 0; i < 4; ++i) shortest = std::min(shortest, (corners[(i + 1) % 4] - corners[i]).norm());
    // Not into the next cell: the border is at least one cell of at most ten along the edge.
    const double reach = std::clamp(0.08 * shortest, 1.5, 4.0);
    std::array<Edge, 4> edges;
    for (std::size_t i = 0; i < 4; ++i) {
      edges[i] = fit_edge(grey, lens, corners[i], corners[(i + 1) % 4], middle, reach, sense);
    }
    for (std::size_t i = 0; i < 4; ++i) {
      const Edge& before = edges[(i + 3) % 4];
      const Edge& after = edges[i];
      const auto at = before.line && after.line ? meeting(*before.line, *after.line) : std::nullopt;
      // The library drew straight lines through bent edges.
      fitted[i] = at && (*at - begin[i]).norm() < kFarthest + before.bow + after.bow;
      if (fitted[i]) corners[i] = *at;
    }
  }
  return fitted;
}

}  // namespace fathom::vision
