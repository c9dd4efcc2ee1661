// Covariance of the filter's state [nu; d; c] over a block, whose measurement is the mean of its samples: what the mean
// shares with the block's end is exact for what is new in the block (docs/decisions/126).
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>

#include "common/likelihood/noise_numbers.hpp"
#include "common/likelihood/run_data.hpp"

namespace fathom::likelihood {

/// What the noise numbers come to over a block of `dt` s, per axis.
template <int N>
struct BlockNoise {
  using Vector = Eigen::Matrix<double, N, 1>;
  Vector rho, rho_colour;       ///< what is left of d and c
  Vector mean_force;            ///< mean of d over the block, over d at its beginning
  Vector white, force, colour;  ///< variances of what is new: in nu, in d, in c
  Vector sensor;                ///< variance of one sample

  BlockNoise(const Noise& noise, double dt) {
    for (int i = 0; i < N; ++i) {
      const AxisNoise& axis = noise[static_cast<std::size_t>(i)];
      rho[i] = std::exp(-dt / axis[kForceMemory]);
      mean_force[i] = (1.0 - rho[i]) * axis[kForceMemory] / dt;
      force[i] = axis[kForce] * axis[kForce] * (1.0 - rho[i] * rho[i]);
      white[i] = axis[kWhiteForce] * axis[kWhiteForce] * dt;
      rho_colour[i] = std::exp(-dt / axis[kColourMemory]);
      colour[i] = axis[kColoured] * axis[kColoured] * (1.0 - rho_colour[i] * rho_colour[i]);
      sensor[i] = axis[kSensor] * axis[kSensor];
      start_force[i] = axis[kForce] * axis[kForce];
      start_colour[i] = axis[kColoured] * axis[kColoured];
    }
  }
  Vector start_force, start_colour;  ///< stationary variances
};

template <int N>
struct CovarianceGain {
  Eigen::Matrix<double, N, N> nu{Eigen::Matrix<double, N, N>::Zero()}, d{nu}, c{nu};
};

template <int N>
class Covariance {
 public:
  using Matrix = Eigen::Matrix<double, N, N>;
  using Vector = Eigen::Matrix<double, N, 1>;

  explicit Covariance(const BlockNoise<N>& noise) : noise_{noise} { begin(); }

  /// At the first sample, from which the velocities were taken.
  void begin() {
    nn_.setZero();
    nd_.setZero();
    nc_.setZero();
    dc_.setZero();
    dd_ = noise_.start_force.asDiagonal();
    cc_ = noise_.start_colour.asDiagonal();
    for (int i = 0; i < N; ++i) {
      nn_(i, i) = 4.0 * noise_.sensor[i] + noise_.start_colour[i];
      nc_(i, i) = -noise_.start_colour[i];
    }
  }
  /// Per axis, variance of the velocity that other axes' errors will add over the block.
  [[nodiscard]] Vector from_others(const Matrix& E) const {
    Vector variance;
    for (int i = 0; i < N; ++i) {
      Eigen::Matrix<double, 1, N> others = E.row(i);
      others[i] = 0.0;
      variance[i] = std::max(0.0, (others * nn_).dot(others));
    }
    return variance;
  }
  /// T = F P, P- = F P F' + Q, and what the block's mean has in common with its end. `H`: what sensors show of nu.
  void advance(const Matrix& E, const Matrix& G, const Matrix& H, const Block& block,
               const std::array<int, static_cast<std::size_t>(N)>& axes) {
    const Vector &rho = noise_.rho, &rho_colour = noise_.rho_colour;
    const Matrix T_nn = E * nn_ + G * nd_.transpose(), T_nd = E * nd_ + G * dd_, T_nc = E * nc_ + G * dc_;
    const Matrix shown_start_n = nn_ * H.transpose() + nc_, shown_start_c = nc_.transpose() * H.transpose() + cc_;
    const Matrix Z_start = H * shown_start_n + shown_start_c;
    const Matrix C_n = T_nn * H.transpose() + T_nc;
    const Matrix C_d = rho.asDiagonal() * (nd_.transpose() * H.transpose() + dc_);
    const Matrix C_c = rho_colour.asDiagonal() * shown_start_c;
    nn_ = T_nn * E.transpose() + T_nd * G.transpose();
    // No measurement sees what rounding leaves of skew, and a craft that is unstable lets it grow.
    nn_ = (0.5 * (nn_ + nn_.transpose())).eval();
    nd_ = T_nd * rho.asDiagonal();
    nc_ = T_nc * rho_colour.asDiagonal();
    dd_ = (rho.asDiagonal() * dd_ * rho.asDiagonal()).eval();
    dc_ = (rho.asDiagonal() * dc_ * rho_colour.asDiagonal()).eval();
    cc_ = (rho_colour.asDiagonal() * cc_ * rho_colour.asDiagonal()).eval();
    const Matrix D_n = nn_ * H.transpose() + nc_, D_d = nd_.transpose() * H.transpose() + dc_;
    const Matrix D_c = nc_.transpose() * H.transpose() + cc_;
    // What is new in this block, exactly: in its end, in its mean, and in both.
    nn_.diagonal() += noise_.white + noise_.force * (block.dt * block.dt / 3.0);
    nd_.diagonal() += noise_.force * (0.5 * block.dt);
    dd_.diagonal() += noise_.force;
    cc_.diagonal() += noise_.colour;
    Vector lag, new_mean, new_n, new_d, new_c;
    for (int i = 0; i < N; ++i) {
      const int a = axes[static_cast<std::size_t>(i)];
      lag[i] = block.lag[a];
      const double force = noise_.force[i] * block.dt;
      new_n[i] = (1.0 - lag[i]) * noise_.white[i] + block.force_end[a] * force * block.dt;
      new_d[i] = block.force_walk[a] * force;
      new_c[i] = (1.0 - lag[i]) * noise_.colour[i];
      new_mean[i] = block.walk[a] * (noise_.white[i] + noise_.colour[i]) + block.force_mean[a] * force * block.dt;
    }
    const Vector late = Vector::Ones() - lag;
    const Matrix across = late.asDiagonal() * (H * C_n + C_c) * lag.asDiagonal();
    S_ = late.asDiagonal() * (H * D_n + D_c) * late.asDiagonal() + lag.asDiagonal() * Z_start * lag.asDiagonal() +
         across + across.transpose();
    for (int i = 0; i < N; ++i) {
      if (block.n[axes[static_cast<std::size_t>(i)]] > 0.0) S_(i, i) += new_mean[i];
    }
    with_mean_.nu = D_n * late.asDiagonal() + C_n * lag.asDiagonal();
    with_mean_.d = D_d * late.asDiagonal() + C_d * lag.asDiagonal();
    with_mean_.c = D_c * late.asDiagonal() + C_c * lag.asDiagonal();
    with_mean_.nu.diagonal() += new_n;
    with_mean_.d.diagonal() += new_d;
    with_mean_.c.diagonal() += new_c;
  }
  /// Of the block's mean as the sensors show it, white noise of their samples apart.
  [[nodiscard]] const Matrix& of_mean() const { return S_; }
  [[nodiscard]] CovarianceGain<N> gain(const Matrix& S_inverse) const {
    CovarianceGain<N> K;
    K.nu = with_mean_.nu * S_inverse;
    K.d = with_mean_.d * S_inverse;
    K.c = with_mean_.c * S_inverse;
    return K;
  }
  /// `L`: of S = L L'.
  void update(const CovarianceGain<N>& K, const Matrix& L) {
    const Matrix n = K.nu * L, d = K.d * L, c = K.c * L;
    nn_ -= n * n.transpose();
    nd_ -= n * d.transpose();
    nc_ -= n * c.transpose();
    dd_ -= d * d.transpose();
    dc_ -= d * c.transpose();
    cc_ -= c * c.transpose();
  }

 private:
  const BlockNoise<N>& noise_;
  Matrix nn_, nd_, nc_, dd_, dc_, cc_;
  Matrix S_;
  CovarianceGain<N> with_mean_;  // covariance of the state with the block's mean
};

}  // namespace fathom::likelihood
