// Sensor streams as arrays over time: block averages, validity, and splines that do not reach across gaps.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstdint>
#include <vector>

namespace fathom::estimation {

/// Three numbers over time, all valid, in the order of time.
struct Series {
  std::vector<double> t;  ///< s
  std::vector<Eigen::Vector3d> x;
  [[nodiscard]] std::size_t size() const { return t.size(); }
  [[nodiscard]] bool empty() const { return t.empty(); }
};

/// Pose over time. Neighbouring quaternions lie in one half-space.
struct PoseSeries {
  std::vector<double> t;                 ///< s
  std::vector<Eigen::Vector3d> p_WB;     ///< m
  std::vector<Eigen::Quaterniond> q_WB;  ///< unit
  std::vector<std::uint8_t> valid;
  bool has_position{false};
  bool has_attitude{false};
  [[nodiscard]] std::size_t size() const { return t.size(); }
  [[nodiscard]] bool empty() const { return t.empty(); }
};

/// Median spacing of time stamps; 0 for fewer than two.
[[nodiscard]] double typical_step(const std::vector<double>& t);
/// Means of blocks of neighbouring samples, so that the rate is at most `rate` [Hz]. Time stamps are averaged alike.
[[nodiscard]] Series block_average(const Series& series, double rate);
/// As above; a block with one invalid pose is invalid.
[[nodiscard]] PoseSeries block_average(const PoseSeries& series, double rate);
/// Flips signs so that neighbours lie in one half-space.
void make_continuous(std::vector<Eigen::Quaterniond>& q);

/// Natural cubic spline, cut where neighbours are further apart than `longest_gap` [s] (0: 2.5 typical steps).
class Spline {
 public:
  explicit Spline(const Series& series, double longest_gap = 0.0);
  /// False outside the data or inside a gap; then `value` is left alone.
  [[nodiscard]] bool at(double t, Eigen::Vector3d& value) const;
  /// Value and slope.
  [[nodiscard]] bool at(double t, Eigen::Vector3d& value, Eigen::Vector3d& slope) const;

 private:
  std::vector<double> t_;
  std::vector<Eigen::Vector3d> x_, curvature_;
  double longest_gap_{};
};

}  // namespace fathom::estimation
