// Normal equations of increments, window by window, and the noise that their misfits show. Known to increments.cpp and
// increment_estimate.cpp only.
#pragma once

#include <algorithm>
#include <span>

#include "common/base/factors.hpp"

namespace fathom::consistency {

inline constexpr int kMostColumns = 24;
using Rows = Eigen::Matrix<double, 3, Eigen::Dynamic, Eigen::ColMajor, 3, kMostColumns>;  // no heap

struct Normals {
  explicit Normals(int size) : h(Eigen::MatrixXd::Zero(size, size)), g(Eigen::VectorXd::Zero(size)) {}
  Eigen::MatrixXd h;
  Eigen::VectorXd g;
  double yy{};
  double weight{};
  void add(const Rows& rows, const Eigen::Vector3d& y, double w) {
    // Three rows at a time are too few for Eigen's blocked product, which costs four times as much.
    const auto n = static_cast<std::size_t>(rows.cols());
    const double* const a = rows.data();
    double* const to = h.data();
    for (std::size_t j = 0; j < n; ++j) {
      const double r0 = w * a[3 * j], r1 = w * a[3 * j + 1], r2 = w * a[3 * j + 2];
      for (std::size_t i = j; i < n; ++i) to[n * j + i] += r0 * a[3 * i] + r1 * a[3 * i + 1] + r2 * a[3 * i + 2];
      g[static_cast<Eigen::Index>(j)] += r0 * y[0] + r1 * y[1] + r2 * y[2];
    }
    yy += w * y.squaredNorm();
    weight += w;
  }
  void add(const Normals& other, double sign) {
    h += sign * other.h;
    g += sign * other.g;
    yy += sign * other.yy;
    weight += sign * other.weight;
  }
  [[nodiscard]] Eigen::VectorXd solve() const { return solve(g); }
  /// Columns are scaled to unit length first; a tiny ridge keeps what the data cannot see at zero.
  [[nodiscard]] Eigen::VectorXd solve(const Eigen::VectorXd& of) const {
    const Eigen::VectorXd scale = (h.diagonal().array() + 1e-300).rsqrt();
    Eigen::MatrixXd scaled = full();
    scaled = scale.asDiagonal() * scaled * scale.asDiagonal();
    scaled.diagonal().array() += 1e-7;
    const Eigen::VectorXd right = scale.asDiagonal() * of;
    return scale.asDiagonal() * solve_symmetric(scaled, right);
  }
  [[nodiscard]] Eigen::MatrixXd full() const { return h.selfadjointView<Eigen::Lower>(); }
  [[nodiscard]] double square(const Eigen::VectorXd& theta) const {
    return std::max(yy - 2.0 * theta.dot(g) + theta.dot(full() * theta), 0.0);
  }
  [[nodiscard]] double cost(const Eigen::VectorXd& theta) const { return square(theta) / std::max(weight, 1e-300); }
};

/// Mean square of a window's misfit, times how much more the blocks' gradients scatter than misfits without a memory
/// would make them. Less it is never taken to be: increments that meet end to end share their noise with opposite
/// signs, which helps where the motion is slow, and not where a quick one shows a number.
[[nodiscard]] double noise_of(std::span<const Normals> blocks, const Eigen::VectorXd& theta);

}  // namespace fathom::consistency
