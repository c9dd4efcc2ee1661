// How a change of accelerations passes through the filter: columns of d x / d number, row by row.
#pragma once

#include <Eigen/Core>

namespace fathom::likelihood {

/// out = A s, or out += A s: row by row, so that whole rows run through the processor's vectors.
template <int N, bool kAdd, typename Left>
void times(const Left& A, const Eigen::Matrix<double, N, Eigen::Dynamic, Eigen::RowMajor>& s,
           Eigen::Matrix<double, N, Eigen::Dynamic, Eigen::RowMajor>& out) {
  static_assert(N == 4 || N == 6);
  for (int i = 0; i < N; ++i) {
    auto row = out.row(i);
    const auto first = A(i, 0) * s.row(0) + A(i, 1) * s.row(1) + A(i, 2) * s.row(2) + A(i, 3) * s.row(3);
    if constexpr (N == 4) {
      if constexpr (kAdd) {
        row += first;
      } else {
        row = first;
      }
    } else {
      const auto all = first + A(i, 4) * s.row(4) + A(i, 5) * s.row(5);
      if constexpr (kAdd) {
        row += all;
      } else {
        row = all;
      }
    }
  }
}

/// How a change of accelerations passes through the filter: d x / d number, gain taken as fixed (log det S and K hardly
/// depend on the numbers).
template <int N>
class Response {
 public:
  using Matrix = Eigen::Matrix<double, N, N>;
  using Vector = Eigen::Matrix<double, N, 1>;
  using Wide = Eigen::Matrix<double, N, Eigen::Dynamic, Eigen::RowMajor>;

  explicit Response(Eigen::Index columns)
      : nu_{Wide::Zero(N, columns)}, d_{nu_}, c_{nu_}, before_{nu_}, shown_{nu_}, next_{nu_} {}

  void clear() {
    nu_.setZero();
    d_.setZero();
    c_.setZero();
  }
  /// Over a block. `acceleration`: N x columns.
  void predict(const Matrix& E, const Matrix& G, const Matrix& Gamma, const Vector& rho, const Vector& rho_colour,
               const Matrix& H, const Wide& acceleration) {
    times<N, false>(H, nu_, before_);
    before_ += c_;
    times<N, false>(E, nu_, next_);
    times<N, true>(G, d_, next_);
    times<N, true>(Gamma, acceleration, next_);
    nu_.swap(next_);
    for (int i = 0; i < N; ++i) {
      d_.row(i) *= rho[i];
      c_.row(i) *= rho_colour[i];
    }
  }
  /// Change of the block's predicted mean; `lag`: share of the block by which it lies before its end.
  Wide& show(const Vector& lag, const Matrix& H) {
    times<N, false>(H, nu_, shown_);
    for (int i = 0; i < N; ++i) shown_.row(i) = (1.0 - lag[i]) * (shown_.row(i) + c_.row(i)) + lag[i] * before_.row(i);
    return shown_;
  }
  Wide& shown() { return shown_; }
  void update(const Matrix& K_nu, const Matrix& K_d, const Matrix& K_c) {
    times<N, true>((-K_nu).eval(), shown_, nu_);
    times<N, true>((-K_d).eval(), shown_, d_);
    times<N, true>((-K_c).eval(), shown_, c_);
  }
  [[nodiscard]] const Wide& nu() const { return nu_; }

 private:
  Wide nu_, d_, c_, before_, shown_, next_;
};

}  // namespace fathom::likelihood
