// d state / d number of the filter for many numbers or features at once, carried from block to block.
#pragma once

#include <Eigen/Core>

#include "common/likelihood/response_step.hpp"

namespace fathom::likelihood {

/// The columns of N axes; accelerations are filled in before each step, the whitened responses read after it. Columns
/// beyond those asked for fill the last lane and stay zero.
template <int N>
class ResponseState {
 public:
  using Wide = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

  explicit ResponseState(Eigen::Index columns)
      : columns_{columns},
        nu_{Wide::Zero(N, padded())},
        d_{nu_},
        c_{nu_},
        acceleration_{nu_},
        added_{nu_},
        whitened_{nu_} {}

  /// N x columns, a view: in this block, m/s^2 or rad/s^2 per unit of the number.
  [[nodiscard]] auto acceleration() { return acceleration_.leftCols(columns_); }
  /// What a number changes in what sensors show; zero unless somebody fills it.
  [[nodiscard]] auto added() { return added_.leftCols(columns_); }
  void step(const ResponseStep<N>& step) {
    advance(step, {acceleration_.data(), added_.data(), nu_.data(), d_.data(), c_.data(), whitened_.data(), padded()});
  }
  /// d innovation / d number.
  [[nodiscard]] auto whitened() const { return whitened_.leftCols(columns_); }
  [[nodiscard]] auto nu() const { return nu_.leftCols(columns_); }

 private:
  [[nodiscard]] Eigen::Index padded() const { return (columns_ + kLanes - 1) / kLanes * kLanes; }

  Eigen::Index columns_;
  Wide nu_, d_, c_, acceleration_, added_, whitened_;
};

}  // namespace fathom::likelihood
