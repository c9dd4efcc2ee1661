// Rows of whitened derivatives, gathered so that sums of their products are products of matrices.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

#include "common/likelihood/response_step.hpp"

namespace fathom::likelihood {

/// Rows times the root of their weight: R'R is then the weighted sum of products.
class GatheredRows {
 public:
  using Rows = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  static constexpr Eigen::Index kMost = 96;  // they fit the processor's nearest memory beside the sums

  explicit GatheredRows(Eigen::Index columns) : rows_(kMost, columns) {}

  template <typename Row>
  void add(const Row& row, double weight) {
    rows_.row(count_++) = std::sqrt(weight) * row;
  }
  [[nodiscard]] bool full() const { return count_ == kMost; }
  [[nodiscard]] bool empty() const { return count_ == 0; }
  [[nodiscard]] Eigen::Index count() const { return count_; }
  [[nodiscard]] Eigen::Index width() const { return rows_.cols(); }
  void clear() { count_ = 0; }
  [[nodiscard]] RowColumns columns(Eigen::Index first, Eigen::Index count) const {
    return {rows_.data() + first, count, rows_.cols()};
  }
  /// Adds R'R of these columns to the lower triangle of a square that begins at `sum`.
  void add_square(Eigen::Index first, Eigen::Index count, double* sum, Eigen::Index stride) const {
    for (Eigen::Index at = 0; at < count; at += kTile)
      add_products(columns(first + at, std::min(kTile, count - at)), columns(first + at, count - at), count_,
                   sum + at * stride + at, stride);
  }
  /// Adds R'R to the lower triangle of `sum`, and begins anew.
  void add_to(Eigen::MatrixXd& sum) {
    add_square(0, rows_.cols(), sum.data(), sum.rows());
    clear();
  }

 private:
  static constexpr Eigen::Index kTile = 8;

  Rows rows_;
  Eigen::Index count_{};
};

}  // namespace fathom::likelihood
