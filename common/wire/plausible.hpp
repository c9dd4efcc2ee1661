// Small helpers of the decode/encode pairs: what may enter, and copies between arrays and Eigen.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <vector>

#include "common/base/error.hpp"

namespace fathom::wire {

/// Rounded single-precision quaternions pass (6e-8 per component), a forgotten normalisation does not.
inline constexpr double kUnitTolerance = 1e-3;

[[nodiscard]] inline bool finite(double value) { return std::isfinite(value); }
[[nodiscard]] inline bool finite(std::span<const double> values) {
  for (const double value : values) {
    if (!std::isfinite(value)) return false;
  }
  return true;
}
[[nodiscard]] inline bool unit(std::span<const double, 4> q) {
  const double norm = std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
  return std::abs(norm - 1.0) < kUnitTolerance;  // false for NaN
}
[[nodiscard]] inline bool length(std::int32_t stated, std::size_t actual) {
  return stated >= 0 && static_cast<std::size_t>(stated) == actual;
}

template <int N>
[[nodiscard]] Eigen::Matrix<double, N, 1> vector(const double (&values)[N]) {
  return Eigen::Map<const Eigen::Matrix<double, N, 1>>(values);
}
[[nodiscard]] inline Eigen::Quaterniond quaternion(const double (&q)[4]) { return {q[0], q[1], q[2], q[3]}; }

template <int N>
void put(const Eigen::Matrix<double, N, 1>& from, double (&to)[N]) {
  Eigen::Map<Eigen::Matrix<double, N, 1>>{to} = from;
}
inline void put(const Eigen::Quaterniond& from, double (&to)[4]) {
  to[0] = from.w();
  to[1] = from.x();
  to[2] = from.y();
  to[3] = from.z();
}

/// A message counts its elements in 32 bits.
template <class T>
[[nodiscard]] std::int32_t count(const std::vector<T>& values) {
  if (values.size() > static_cast<std::size_t>(std::numeric_limits<std::int32_t>::max())) {
    throw InputError("a message holds at most 2147483647 elements");
  }
  return static_cast<std::int32_t>(values.size());
}

}  // namespace fathom::wire
