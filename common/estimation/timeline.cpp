#include "common/estimation/timeline.hpp"

#include <algorithm>
#include <cmath>

#include "common/base/statistics.hpp"

namespace fathom::estimation {
namespace {

std::size_t block_size(const std::vector<double>& t, double rate) {
  const double step = typical_step(t);
  // The small allowance keeps a 25 Hz stream with jittering stamps as it is.
  return step > 0.0 ? std::max<std::size_t>(1, static_cast<std::size_t>(std::ceil(1.0 / (rate * step) - 0.05))) : 1;
}

/// Ends of the block that begins at `first`: at most `size` samples and never across a gap.
std::size_t block_end(const std::vector<double>& t, std::size_t first, std::size_t size, double step) {
  std::size_t end = first + 1;
  while (end < t.size() && end - first < size && t[end] - t[end - 1] < 2.5 * step) ++end;
  return end;
}

}  // namespace

double typical_step(const std::vector<double>& t) {
  std::vector<double> steps;
  for (std::size_t i = 1; i < t.size(); ++i) steps.push_back(t[i] - t[i - 1]);
  return median(std::move(steps));
}

Series block_average(const Series& series, double rate) {
  const std::size_t size = block_size(series.t, rate);
  if (size == 1) return series;
  const double step = typical_step(series.t);
  Series mean;
  for (std::size_t first = 0, end = 0; first < series.size(); first = end) {
    end = block_end(series.t, first, size, step);
    const double share = 1.0 / static_cast<double>(end - first);
    double t = 0.0;
    Eigen::Vector3d x = Eigen::Vector3d::Zero();
    for (std::size_t i = first; i < end; ++i) {
      t += share * (series.t[i] - series.t[first]);
      x += share * series.x[i];
    }
    mean.t.push_back(series.t[first] + t);
    mean.x.push_back(x);
  }
  return mean;
}

PoseSeries block_average(const PoseSeries& series, double rate) {
  const std::size_t size = block_size(series.t, rate);
  if (size == 1) return series;
  const double step = typical_step(series.t);
  PoseSeries mean;
  mean.has_position = series.has_position;
  mean.has_attitude = series.has_attitude;
  for (std::size_t first = 0, end = 0; first < series.size(); first = end) {
    end = block_end(series.t, first, size, step);
    const double share = 1.0 / static_cast<double>(end - first);
    double t = 0.0;
    Eigen::Vector3d p = Eigen::Vector3d::Zero();
    Eigen::Vector4d q = Eigen::Vector4d::Zero();
    bool valid = true;
    for (std::size_t i = first; i < end; ++i) {
      t += share * (series.t[i] - series.t[first]);
      p += share * series.p_WB[i];
      q += series.q_WB[i].coeffs();
      valid = valid && series.valid[i] != 0;
    }
    mean.t.push_back(series.t[first] + t);
    mean.p_WB.push_back(p);
    mean.q_WB.push_back(q.norm() > 1e-9 ? Eigen::Quaterniond(q.normalized()) : series.q_WB[first]);
    mean.valid.push_back(valid ? 1 : 0);
  }
  return mean;
}

void make_continuous(std::vector<Eigen::Quaterniond>& q) {
  for (std::size_t i = 1; i < q.size(); ++i) {
    if (q[i].dot(q[i - 1]) < 0.0) q[i].coeffs() = -q[i].coeffs();
  }
}

Spline::Spline(const Series& series, double longest_gap) : t_(series.t), x_(series.x) {
  longest_gap_ = longest_gap > 0.0 ? longest_gap : 2.5 * typical_step(t_);
  const std::size_t n = t_.size();
  curvature_.assign(n, Eigen::Vector3d::Zero());
  std::vector<double> upper(n, 0.0);
  // Natural ends at the data's ends and at both sides of every gap: each segment is its own tridiagonal system.
  for (std::size_t i = 1; i + 1 < n; ++i) {
    const double before = t_[i] - t_[i - 1];
    const double after = t_[i + 1] - t_[i];
    if (before > longest_gap_ || after > longest_gap_ || before <= 0.0 || after <= 0.0) continue;
    const double pivot = 2.0 * (before + after) - before * upper[i - 1];
    upper[i] = after / pivot;
    const Eigen::Vector3d bend = 6.0 * ((x_[i + 1] - x_[i]) / after - (x_[i] - x_[i - 1]) / before);
    curvature_[i] = (bend - before * curvature_[i - 1]) / pivot;
  }
  for (std::size_t i = n; i-- > 1;) {
    if (upper[i - 1] != 0.0) curvature_[i - 1] -= upper[i - 1] * curvature_[i];
  }
}

bool Spline::at(double t, Eigen::Vector3d& value) const {
  Eigen::Vector3d slope;
  return at(t, value, slope);
}

bool Spline::at(double t, Eigen::Vector3d& value, Eigen::Vector3d& slope) const {
  if (t_.size() < 2 || t < t_.front() || t > t_.back()) return false;
  const auto above = std::upper_bound(t_.begin(), t_.end(), t);
  const std::size_t j = std::min(static_cast<std::size_t>(above - t_.begin()), t_.size() - 1);
  const std::size_t i = j - 1;
  const double step = t_[j] - t_[i];
  if (step > longest_gap_ || step <= 0.0) return false;
  const double b = (t - t_[i]) / step;
  const double a = 1.0 - b;
  const double bend = step * step / 6.0;
  value = a * x_[i] + b * x_[j] + bend * ((a * a * a - a) * curvature_[i] + (b * b * b - b) * curvature_[j]);
  slope =
      (x_[j] - x_[i]) / step + step / 6.0 * ((1.0 - 3.0 * a * a) * curvature_[i] + (3.0 * b * b - 1.0) * curvature_[j]);
  return true;
}

}  // namespace fathom::estimation
