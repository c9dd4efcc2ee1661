// The recursion of one run, for a number of axes known to the compiler. Only filter_four.cpp and filter_six.cpp include
// it.
#pragma once

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "common/likelihood/filter.hpp"
#include "common/likelihood/transition.hpp"

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
  const Wide& shown(const Vector& lag, const Matrix& H) {
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

template <int N>
class RunPass {
 public:
  using Matrix = Eigen::Matrix<double, N, N>;
  using Vector = Eigen::Matrix<double, N, 1>;
  using Wide = typename Response<N>::Wide;

  RunPass(const Problem& problem, const Hypothesis& hypothesis, const std::vector<Number>& numbers, const Noise& noise,
          std::size_t run_index, const PassOptions& options, RunReference* reference)
      : problem_{problem},
        numbers_{numbers},
        noise_{noise},
        run_{problem.runs[run_index]},
        run_index_{run_index},
        options_{options},
        reference_{reference},
        plant_{hypothesis, numbers, run_, run_index, options.derivatives},
        sensor_{plant_.model(), run_.dt()},
        response_{options.derivatives ? static_cast<Eigen::Index>(numbers.size()) : 0} {
    for (int i = 0; i < N; ++i) axes_[static_cast<std::size_t>(i)] = problem.axes[static_cast<std::size_t>(i)];
    const Matrix6d shown = SensorStage::slope(plant_.model(), run_.dt());
    for (int i = 0; i < N; ++i)
      for (int j = 0; j < N; ++j) H_(i, j) = shown(axis(i), axis(j));
    for (std::size_t j = 0; j < numbers.size(); ++j) {
      const Number& number = numbers[j];
      if (number.kind == NumberKind::kEffect &&
          stage_of(plant_.model().effects[static_cast<std::size_t>(number.index)]) == Stage::kSensor)
        sensor_numbers_.push_back(j);
    }
    bias_ = hypothesis.runs[run_index].velocity_bias;
  }

  PassResult run() {
    PassResult result;
    const auto p = static_cast<Eigen::Index>(options_.derivatives ? numbers_.size() : 0);
    result.information.setZero(p, p);
    result.gradient.setZero(p);
    const auto& blocks = run_.blocks();
    prepare(result, blocks.size());
    begin();
    for (std::size_t b = 0; b < blocks.size() && result.finite; ++b) step(b, blocks[b], result);
    if (options_.derivatives) {
      result.information.template triangularView<Eigen::StrictlyUpper>() = result.information.transpose();
    }
    return result;
  }

 private:
  [[nodiscard]] int axis(int i) const { return axes_[static_cast<std::size_t>(i)]; }

  void prepare(PassResult& result, std::size_t blocks) {
    const auto p = static_cast<Eigen::Index>(numbers_.size());
    if (options_.derivatives) {
      columns_.setZero(6, p);
      nu_columns_.setZero(6, p);
      wrenches_.setZero(6, p);
      B_.setZero(N, p);
      J_.setZero(N, p);
    }
    if (options_.reduced)
      result.reduced.assign(1, std::vector<std::vector<ReducedBlock>>(N, std::vector<ReducedBlock>(blocks)));
    for (int i = 0; i < N; ++i) {
      tails_.emplace_back(noise_[static_cast<std::size_t>(i)].tail);
    }
    const double dt = run_.blocks().empty() ? 1.0 : run_.blocks().front().dt;
    for (int i = 0; i < N; ++i) {
      const AxisNoise& noise = noise_[static_cast<std::size_t>(i)];
      const double force = noise[kForce], memory = noise[kForceMemory], colour = noise[kColoured];
      rho_[i] = std::exp(-dt / memory);
      mean_force_[i] = (1.0 - rho_[i]) * memory / dt;
      const double fresh = force * force * (1.0 - rho_[i] * rho_[i]);
      Q_white_[i] = noise[kWhiteForce] * noise[kWhiteForce] * dt;
      Q_force_[i] = fresh;
      rho_colour_[i] = std::exp(-dt / noise[kColourMemory]);
      Q_c_[i] = colour * colour * (1.0 - rho_colour_[i] * rho_colour_[i]);
      sensor_variance_[i] = noise[kSensor] * noise[kSensor];
      force_decay_[i] = std::exp(-run_.h() / memory);
      force_half_[i] = std::exp(-0.5 * run_.h() / memory);
    }
    if (reference_ == nullptr) return;
    const auto n = static_cast<Eigen::Index>(blocks);
    reference_->axes = N;
    reference_->numbers = static_cast<int>(p);
    reference_->gains.assign(blocks * 7 * N * N, 0.0);
    reference_->rho = rho_;
    reference_->rho_colour = rho_colour_;
    reference_->innovation.setZero(N, n);
    reference_->slope.setZero(N, n);
    reference_->information.setZero(N, n);
    reference_->nu_middle.setZero(6, n);
    reference_->nu_dot.setZero(6, n);
    reference_->nu_end.setZero(6, n);
    reference_->trace.setZero(6, static_cast<Eigen::Index>(run_.trial().size()));
    reference_->J.setZero(N * n, p);
    reference_->B.setZero(N * n, p);
  }

  void begin() {
    nu_ = run_.start();
    d_.setZero();
    c_.setZero();
    P_nn_.setZero();
    P_nd_.setZero();
    P_nc_.setZero();
    P_dc_.setZero();
    P_dd_.setZero();
    P_cc_.setZero();
    for (int i = 0; i < N; ++i) {
      const AxisNoise& noise = noise_[static_cast<std::size_t>(i)];
      const double colour = noise[kColoured] * noise[kColoured], force = noise[kForce] * noise[kForce];
      P_nn_(i, i) = 4.0 * sensor_variance_[i] + colour;
      P_nc_(i, i) = -colour;
      P_cc_(i, i) = colour;
      P_dd_(i, i) = force;
    }
    plant_.begin(nu_);
    sensor_.begin(nu_);
    scales_ = {};
  }

  /// Velocities of a block by third-order steps (Kutta), with their mean over the samples used.
  void roll(const Block& block, Vector6d& mean) {
    Vector6d sum = Vector6d::Zero();
    Vector d = d_;
    const double h = run_.h();
    const auto dof = problem_.vehicle->dof;
    for (std::size_t k = block.first; k < block.last; ++k) {
      for (Eigen::Index i = 0; i < 6; ++i) {  // axes that are not simulated, as measured
        if (!dof[static_cast<std::size_t>(i)]) nu_[i] = run_.intervals()[k].told[i];
      }
      for (int s = 0; s < run_.substeps(); ++s) {
        plant_.at_substep(k, s);
        Vector6d random = Vector6d::Zero();
        for (int i = 0; i < N; ++i) random[axis(i)] = force_half_[i] * d[i];
        const Vector6d k1 = plant_.acceleration(nu_) + random;
        const Vector6d k2 = plant_.acceleration(nu_ + 0.5 * h * k1) + random;
        const Vector6d k3 = plant_.acceleration(nu_ + h * (2.0 * k2 - k1)) + random;
        nu_ += h / 6.0 * (k1 + 4.0 * k2 + k3);
        d = d.cwiseProduct(force_decay_);
      }
      for (std::size_t i = 0; i < 6; ++i) {
        const auto a = static_cast<Eigen::Index>(i);
        if (!dof[i]) nu_[a] = run_.trial().nu[k + 1][a];
      }
      if (reference_ != nullptr) reference_->trace.col(static_cast<Eigen::Index>(k + 1)) = nu_;
      sensor_.push(nu_);
      for (std::size_t i = 0; i < 6; ++i) {
        if (run_.used(k + 1, i)) sum[static_cast<Eigen::Index>(i)] += nu_[static_cast<Eigen::Index>(i)];
      }
    }
    for (Eigen::Index i = 0; i < 6; ++i) mean[i] = block.n[i] > 0.0 ? sum[i] / block.n[i] : nu_[i];
  }

  void step(std::size_t b, const Block& block, PassResult& result) {
    const auto at = static_cast<Eigen::Index>(b);
    const Vector6d nu_start = nu_;
    const Vector c_start = c_;
    Vector6d mean;
    roll(block, mean);
    if (!nu_.allFinite() || nu_.cwiseAbs().maxCoeff() > kAbsurd) {
      result.finite = false;
      return;
    }
    const Vector d_start = d_;
    d_ = d_.cwiseProduct(rho_);
    c_ = c_.cwiseProduct(rho_colour_);

    // The block's middle: slope, transition, columns.
    Vector6d middle = 0.5 * (nu_start + nu_);
    plant_.at_middle(b);
    const Vector6d nu_dot = plant_.acceleration(middle);
    const Matrix6d slope = plant_.slope(middle, nu_dot);
    Matrix A;
    for (int i = 0; i < N; ++i)
      for (int j = 0; j < N; ++j) A(i, j) = slope(axis(i), axis(j));
    const Transition<N> transition{A, block.dt};
    const Matrix& E = transition.E;
    const Matrix G = transition.Gamma * mean_force_.asDiagonal();

    // Covariances: T = F P, P- = F P F' + Q, and what the block's mean has in common with its end.
    const Matrix T_nn = E * P_nn_ + G * P_nd_.transpose(), T_nd = E * P_nd_ + G * P_dd_, T_nc = E * P_nc_ + G * P_dc_;
    const Matrix shown_start_n = P_nn_ * H_.transpose() + P_nc_,
                 shown_start_c = P_nc_.transpose() * H_.transpose() + P_cc_;
    const Matrix Z_start = H_ * shown_start_n + shown_start_c;
    const Matrix C_n = T_nn * H_.transpose() + T_nc;
    const Matrix C_d = rho_.asDiagonal() * (P_nd_.transpose() * H_.transpose() + P_dc_);
    const Matrix C_c = rho_colour_.asDiagonal() * shown_start_c;
    if (options_.reduced) {
      for (int i = 0; i < N; ++i) {
        Eigen::Matrix<double, 1, N> others = E.row(i);
        others[i] = 0.0;
        others_[i] = std::max(0.0, (others * P_nn_).dot(others));
      }
    }
    P_nn_ = T_nn * E.transpose() + T_nd * G.transpose();
    P_nd_ = T_nd * rho_.asDiagonal();
    P_nc_ = T_nc * rho_colour_.asDiagonal();
    P_dd_ = (rho_.asDiagonal() * P_dd_ * rho_.asDiagonal()).eval();
    P_dc_ = (rho_.asDiagonal() * P_dc_ * rho_colour_.asDiagonal()).eval();
    P_cc_ = (rho_colour_.asDiagonal() * P_cc_ * rho_colour_.asDiagonal()).eval();
    const Matrix D_n = P_nn_ * H_.transpose() + P_nc_, D_d = P_nd_.transpose() * H_.transpose() + P_dc_;
    const Matrix D_c = P_nc_.transpose() * H_.transpose() + P_cc_;
    // What is new in this block, exactly: in its end, in its mean, and in both.
    P_nn_.diagonal() += Q_white_ + Q_force_ * (block.dt * block.dt / 3.0);
    P_nd_.diagonal() += Q_force_ * (0.5 * block.dt);
    P_dd_.diagonal() += Q_force_;
    P_cc_.diagonal() += Q_c_;
    Vector lag, late, new_mean, new_n, new_d, new_c;
    bool measured = false;
    for (int i = 0; i < N; ++i) {
      const int a = axis(i);
      lag[i] = block.lag[a];
      measured = measured || block.n[a] > 0.0;
      const double force = Q_force_[i] * block.dt;
      new_n[i] = (1.0 - lag[i]) * Q_white_[i] + block.force_end[a] * force * block.dt;
      new_d[i] = block.force_walk[a] * force;
      new_c[i] = (1.0 - lag[i]) * Q_c_[i];
      new_mean[i] = block.walk[a] * (Q_white_[i] + Q_c_[i]) + block.force_mean[a] * force * block.dt;
    }
    late = Vector::Ones() - lag;
    const Matrix across = late.asDiagonal() * (H_ * C_n + C_c) * lag.asDiagonal();
    Matrix S = late.asDiagonal() * (H_ * D_n + D_c) * late.asDiagonal() +
               lag.asDiagonal() * Z_start * lag.asDiagonal() + across + across.transpose();
    Vector e;
    const Vector6d shown = sensor_.empty() ? mean : sensor_.mean(run_.block_size(), plant_.model());
    for (int i = 0; i < N; ++i) {
      const int a = axis(i);
      S(i, i) += block.n[a] > 0.0 ? new_mean[i] + sensor_variance_[i] / block.n[a] : kNotMeasured;
      e[i] = block.n[a] > 0.0 ? block.y[a] - shown[a] - bias_[a] - (late[i] * c_[i] + lag[i] * c_start[i]) : 0.0;
    }
    const Eigen::LLT<Matrix> llt{0.5 * (S + S.transpose())};
    const Matrix L = llt.matrixL();
    if (!(L.diagonal().minCoeff() > 0.0)) {
      result.finite = false;
      return;
    }
    const Matrix L_inverse = llt.matrixL().solve(Matrix::Identity());
    const Vector innovation = L_inverse * e;
    const Matrix whiten = L_inverse.transpose() * L_inverse;  // S^-1
    bool update = measured, score = measured && block.scored;
    if (options_.horizon) {
      const double cycle = options_.horizon->lead + options_.horizon->hidden;
      const double into = std::fmod(run_.trial().t[block.last] - run_.first_time() + options_.horizon->phase, cycle);
      update = measured && into <= options_.horizon->lead;
      score = score && into > options_.horizon->lead;
    }
    Matrix with_mean_n = D_n * late.asDiagonal() + C_n * lag.asDiagonal();
    Matrix with_mean_d = D_d * late.asDiagonal() + C_d * lag.asDiagonal();
    Matrix with_mean_c = D_c * late.asDiagonal() + C_c * lag.asDiagonal();
    with_mean_n.diagonal() += new_n;
    with_mean_d.diagonal() += new_d;
    with_mean_c.diagonal() += new_c;
    const Matrix K_n = with_mean_n * whiten, K_d = with_mean_d * whiten, K_c = with_mean_c * whiten;

    if (options_.derivatives) sensitivities(b, middle, nu_dot, transition, G, lag);
    Vector score_slope = Vector::Zero(), score_information = Vector::Zero();
    for (int i = 0; i < N; ++i) {
      if (block.n[axis(i)] == 0.0) continue;
      const auto a = static_cast<std::size_t>(i);
      const Tail& tail = noise_[a].tail;
      const TailScore density = tails_[a](innovation[i], scales_[a].value(tail));
      if (score) {
        result.log_likelihood += density.log_density - std::log(L(i, i));
        result.scored += 1.0;
        score_slope[i] = density.slope;
        score_information[i] = density.information;
      }
      if (update && tail.follows) scales_[a].see(innovation[i] * innovation[i], block.dt);
    }
    if (options_.derivatives) {
      Wide& J = response_.shown();
      times<N, false>((-L_inverse).eval(), J, J_);
      if (score) {
        result.gradient.noalias() -= J_.transpose().lazyProduct(score_slope);
        for (int i = 0; i < N; ++i) {
          if (score_information[i] > 0.0)
            result.information.template selfadjointView<Eigen::Lower>().rankUpdate(J_.row(i).transpose(),
                                                                                   score_information[i]);
        }
      }
    }
    if (options_.reduced) reduce(b, block, E, transition, d_start, shown, lag, result, score);
    if (reference_ != nullptr) {
      keep(b, E, G, transition.Gamma, update ? K_n : Matrix{Matrix::Zero()}, update ? K_d : Matrix{Matrix::Zero()},
           update ? K_c : Matrix{Matrix::Zero()}, L_inverse);
      reference_->innovation.col(at) = innovation;
      reference_->slope.col(at) = score_slope;
      reference_->information.col(at) = score_information;
      reference_->nu_middle.col(at) = middle;
      reference_->nu_dot.col(at) = nu_dot;
      if (options_.derivatives) {
        reference_->J.middleRows(N * at, N) = J_;
        reference_->B.middleRows(N * at, N) = B_;
      }
    }
    if (update) {
      for (int i = 0; i < N; ++i) nu_[axis(i)] += K_n.row(i).dot(e);
      d_ += K_d * e;
      c_ += K_c * e;
      const Matrix KS_n = K_n * L, KS_d = K_d * L, KS_c = K_c * L;
      P_nn_ -= KS_n * KS_n.transpose();
      P_nd_ -= KS_n * KS_d.transpose();
      P_nc_ -= KS_n * KS_c.transpose();
      P_dd_ -= KS_d * KS_d.transpose();
      P_dc_ -= KS_d * KS_c.transpose();
      P_cc_ -= KS_c * KS_c.transpose();
      if (options_.derivatives) response_.update(K_n, K_d, K_c);
    }
    if (options_.reduced) {
      for (int i = 0; i < N; ++i) {
        ReducedBlock& reduced = result.reduced[0][static_cast<std::size_t>(i)][b];
        const double step = rolled_end_[i] - nu_[axis(i)];
        reduced.r += step;
        reduced.z += (1.0 - lag[i]) * step;
      }
    }
    if (reference_ != nullptr) reference_->nu_end.col(at) = nu_;
    plant_.end_block(b, nu_);
    if (options_.derivatives && plant_.remembers()) {
      for (int i = 0; i < N; ++i) nu_columns_.row(axis(i)) = response_.nu().row(i);
      plant_.remember_columns(b, nu_columns_, wrenches_);
    }
  }

  void sensitivities(std::size_t b, const Vector6d& middle, const Vector6d& nu_dot, const Transition<N>& transition,
                     const Matrix& G, const Vector& lag) {
    plant_.columns(b, middle, nu_dot, columns_);
    if (plant_.remembers()) columns_ += plant_.inverse_inertia(middle, nu_dot) * wrenches_;
    for (int i = 0; i < N; ++i) B_.row(i) = columns_.row(axis(i));
    response_.predict(transition.E, G, transition.Gamma, rho_, rho_colour_, H_, B_);
    Wide& shown = const_cast<Wide&>(response_.shown(lag, H_));
    for (std::size_t j = 0; j < numbers_.size(); ++j) {
      if (numbers_[j].kind != NumberKind::kVelocityBias || numbers_[j].run != static_cast<int>(run_index_)) continue;
      for (int i = 0; i < N; ++i) shown(i, static_cast<Eigen::Index>(j)) += axis(i) == numbers_[j].index ? 1.0 : 0.0;
    }
    if (sensor_numbers_.empty()) return;
    const Vector6d now = sensor_.mean(run_.block_size(), plant_.model());
    for (const std::size_t j : sensor_numbers_) {
      model::Model moved = plant_.model();
      moved.effects[static_cast<std::size_t>(numbers_[j].index)]
          .theta[static_cast<std::size_t>(numbers_[j].component)] += numbers_[j].step;
      const Vector6d change = (sensor_.mean(run_.block_size(), moved) - now) / numbers_[j].step;
      for (int i = 0; i < N; ++i) shown(i, static_cast<Eigen::Index>(j)) += change[axis(i)];
    }
  }

  void reduce(std::size_t b, const Block& block, const Matrix& E, const Transition<N>& transition,
              const Vector& d_start, const Vector6d& shown, const Vector& lag, PassResult& result, bool score) {
    for (int i = 0; i < N; ++i) {
      const int a = axis(i);
      rolled_end_[i] = nu_[a];
      ReducedBlock& reduced = result.reduced[0][static_cast<std::size_t>(i)][b];
      reduced.F = E(i, i);
      reduced.G = transition.Gamma(i, i);
      // Without the random force of the estimate itself: its own axis' part is what the reduced filter adds anew.
      reduced.r = -transition.Gamma(i, i) * mean_force_[i] * d_start[i];
      reduced.z = block.y[a] - shown[a] - bias_[a];
      reduced.lag = lag[i];
      reduced.walk = block.walk[a];
      reduced.force_end = block.force_end[a];
      reduced.force_walk = block.force_walk[a];
      reduced.force_mean = block.force_mean[a];
      reduced.n = block.n[a];
      reduced.others = others_[i];
      reduced.dt = block.dt;
      reduced.scored = score;
    }
  }

  void keep(std::size_t b, const Matrix& E, const Matrix& G, const Matrix& Gamma, const Matrix& K_n, const Matrix& K_d,
            const Matrix& K_c, const Matrix& L_inverse) {
    double* to = reference_->gains.data() + b * 7 * N * N;
    for (const Matrix* matrix : {&E, &G, &Gamma, &K_n, &K_d, &K_c, &L_inverse}) {
      Eigen::Map<Matrix>{to} = *matrix;
      to += N * N;
    }
  }

  static constexpr double kAbsurd = 50.0;       // m/s, rad/s
  static constexpr double kNotMeasured = 1e12;  // variance that no velocity has: the gain of such an axis is zero

  const Problem& problem_;
  const std::vector<Number>& numbers_;
  const Noise& noise_;
  const RunData& run_;
  std::size_t run_index_;
  const PassOptions& options_;
  RunReference* reference_;
  Plant plant_;
  SensorStage sensor_;
  Response<N> response_;
  std::array<int, static_cast<std::size_t>(N)> axes_{};
  Matrix H_{Matrix::Identity()};
  std::vector<std::size_t> sensor_numbers_;
  Vector6d bias_{Vector6d::Zero()};
  std::vector<TailDensity> tails_;
  std::array<FollowedScale, static_cast<std::size_t>(N)> scales_{};
  Vector rho_, rho_colour_, mean_force_, Q_white_, Q_force_, Q_c_, sensor_variance_, force_decay_, force_half_;
  Vector rolled_end_{Vector::Zero()}, others_{Vector::Zero()};
  Vector6d nu_{Vector6d::Zero()};
  Vector d_{Vector::Zero()}, c_{Vector::Zero()};
  Matrix P_nn_, P_nd_, P_nc_, P_dd_, P_dc_, P_cc_;
  Columns columns_, nu_columns_, wrenches_;
  Wide B_, J_;
};

}  // namespace fathom::likelihood
