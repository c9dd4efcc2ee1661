// What regressors hand to estimators: scalar equations h . theta = y of known noise, in fixed storage.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <span>

#include "common/base/time.hpp"

namespace fathom::identification {

constexpr int kMaxParameters = 32;
using ParameterVector = Eigen::Matrix<double, Eigen::Dynamic, 1, Eigen::ColMajor, kMaxParameters, 1>;
using ParameterMatrix =
    Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, kMaxParameters, kMaxParameters>;

/// One scalar equation.
struct Row {
  int axis{};          ///< 0..5 = X Y Z K M N
  ParameterVector h;   ///< regressor
  double y{};          ///< N or N m
  double variance{};   ///< of y
  int derivative{-1};  ///< entry of h that is the axis's acceleration, the noisiest one; -1: none
};

/// The equations of one instant, at most one per axis.
struct RowBlock {
  Utime utime{};  ///< when it is true: the centre of its window
  Utime end{};    ///< last sample that entered
  int count{};
  std::array<Row, 6> rows;
  [[nodiscard]] std::span<const Row> view() const { return {rows.data(), static_cast<std::size_t>(count)}; }
};

}  // namespace fathom::identification
