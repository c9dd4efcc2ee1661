// Rows of whitened derivatives, gathered so that sums of their products are products of matrices.
#pragma once

#include <Eigen/Core>
#include <cmath>

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
  [[nodiscard]] auto rows() const { return rows_.topRows(count_); }
  void clear() { count_ = 0; }
  /// Adds R'R to the lower triangle of `sum`, and begins anew.
  void add_to(Eigen::MatrixXd& sum) {
    if (count_ > 0) sum.selfadjointView<Eigen::Lower>().rankUpdate(rows().transpose());
    clear();
  }

 private:
  Rows rows_;
  Eigen::Index count_{};
};

}  // namespace fathom::likelihood
