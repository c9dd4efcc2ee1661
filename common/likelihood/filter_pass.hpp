// The recursion of one run, for a number of axes known to the compiler. Only filter_four.cpp and filter_six.cpp include
// it.
#pragma once

#include <Eigen/Cholesky>
#include <cmath>

#include "common/likelihood/covariance.hpp"
#include "common/likelihood/filter.hpp"
#include "common/likelihood/gathered_rows.hpp"
#include "common/likelihood/response_state.hpp"
#include "common/likelihood/transition.hpp"

namespace fathom::likelihood {

template <int N>
class RunPass {
 public:
  using Matrix = Eigen::Matrix<double, N, N>;
  using Vector = Eigen::Matrix<double, N, 1>;

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
        response_{options.derivatives ? static_cast<Eigen::Index>(numbers.size()) : 0},
        rows_{options.derivatives ? static_cast<Eigen::Index>(numbers.size()) : 0},
        block_noise_{noise, run_.blocks().empty() ? 1.0 : run_.blocks().front().dt},
        covariance_{block_noise_} {
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
    response_step_.H = H_;
    response_step_.shows_nu_alone = H_.isIdentity(0.0);
    response_step_.mean_force = block_noise_.mean_force;
    response_step_.rho = block_noise_.rho;
    response_step_.rho_colour = block_noise_.rho_colour;
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
      rows_.add_to(result.information);
      result.information.template triangularView<Eigen::StrictlyUpper>() = result.information.transpose();
    }
    return result;
  }

 private:
  [[nodiscard]] int axis(int i) const { return axes_[static_cast<std::size_t>(i)]; }
  [[nodiscard]] Vector lag_of(const Block& block) const {
    Vector lag;
    for (int i = 0; i < N; ++i) lag[i] = block.lag[axis(i)];
    return lag;
  }

  void prepare(PassResult& result, std::size_t blocks) {
    const auto p = static_cast<Eigen::Index>(numbers_.size());
    if (options_.derivatives) {
      columns_.setZero(6, p);
      nu_columns_.setZero(6, p);
      wrenches_.setZero(6, p);
    }
    if (options_.reduced)
      result.reduced.assign(1, std::vector<std::vector<ReducedBlock>>(N, std::vector<ReducedBlock>(blocks)));
    for (int i = 0; i < N; ++i) {
      const AxisNoise& noise = noise_[static_cast<std::size_t>(i)];
      tails_.emplace_back(noise.tail);
      force_decay_[i] = std::exp(-run_.h() / noise[kForceMemory]);
      force_half_[i] = std::exp(-0.5 * run_.h() / noise[kForceMemory]);
    }
    if (reference_ == nullptr) return;
    const auto n = static_cast<Eigen::Index>(blocks);
    reference_->axes = N;
    reference_->numbers = static_cast<int>(p);
    reference_->gains.assign(blocks * RunReference::kMatrices * N * N, 0.0);
    reference_->mean_force = block_noise_.mean_force;
    reference_->rho = block_noise_.rho;
    reference_->rho_colour = block_noise_.rho_colour;
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
    covariance_.begin();
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
    d_ = d_.cwiseProduct(block_noise_.rho);
    c_ = c_.cwiseProduct(block_noise_.rho_colour);

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
    const Matrix G = transition.Gamma * block_noise_.mean_force.asDiagonal();

    if (options_.reduced) others_ = covariance_.from_others(E);
    const Vector lag = lag_of(block);
    covariance_.advance(E, G, H_, block, axes_);
    Matrix S = covariance_.of_mean();
    Vector e;
    bool measured = false;
    const Vector6d shown = sensor_.empty() ? mean : sensor_.mean(run_.block_size(), plant_.model());
    for (int i = 0; i < N; ++i) {
      const int a = axis(i);
      measured = measured || block.n[a] > 0.0;
      S(i, i) += block.n[a] > 0.0 ? block_noise_.sensor[i] / block.n[a] : kNotMeasured;
      e[i] = block.n[a] > 0.0 ? block.y[a] - shown[a] - bias_[a] - ((1.0 - lag[i]) * c_[i] + lag[i] * c_start[i]) : 0.0;
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
    const CovarianceGain<N> K = update ? covariance_.gain(whiten) : CovarianceGain<N>{};
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
      sensitivities(b, middle, nu_dot, transition, K, L_inverse, lag);
      if (score) {
        const auto J = response_.whitened();
        result.gradient.noalias() -= J.transpose().lazyProduct(score_slope);
        for (int i = 0; i < N; ++i) {
          if (score_information[i] > 0.0) rows_.add(J.row(i), score_information[i]);
          if (rows_.full()) rows_.add_to(result.information);
        }
      }
    }
    if (options_.reduced) reduce(b, block, E, transition, d_start, shown, lag, result, score);
    if (reference_ != nullptr) {
      keep(b, E, transition.Gamma, K, L_inverse);
      reference_->innovation.col(at) = innovation;
      reference_->slope.col(at) = score_slope;
      reference_->information.col(at) = score_information;
      reference_->nu_middle.col(at) = middle;
      reference_->nu_dot.col(at) = nu_dot;
      if (options_.derivatives) {
        reference_->J.middleRows(N * at, N) = response_.whitened();
        reference_->B.middleRows(N * at, N) = response_.acceleration().leftCols(rows_.width());
      }
    }
    if (update) {
      for (int i = 0; i < N; ++i) nu_[axis(i)] += K.nu.row(i).dot(e);
      d_ += K.d * e;
      c_ += K.c * e;
      covariance_.update(K, L);
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
                     const CovarianceGain<N>& K, const Matrix& L_inverse, const Vector& lag) {
    plant_.columns(b, middle, nu_dot, columns_);
    if (plant_.remembers()) columns_ += plant_.inverse_inertia(middle, nu_dot) * wrenches_;
    for (int i = 0; i < N; ++i) response_.acceleration().row(i).head(columns_.cols()) = columns_.row(axis(i));
    for (std::size_t j = 0; j < numbers_.size(); ++j) {
      if (numbers_[j].kind != NumberKind::kVelocityBias || numbers_[j].run != static_cast<int>(run_index_)) continue;
      for (int i = 0; i < N; ++i)
        response_.added()(i, static_cast<Eigen::Index>(j)) = axis(i) == numbers_[j].index ? 1.0 : 0.0;
    }
    sensor_sensitivities();
    response_step_.E = transition.E;
    response_step_.Gamma = transition.Gamma;
    response_step_.K_nu = K.nu;
    response_step_.K_d = K.d;
    response_step_.K_c = K.c;
    response_step_.L_inverse = L_inverse;
    response_step_.lag = lag;
    response_.step(response_step_);
  }

  void sensor_sensitivities() {
    if (sensor_numbers_.empty()) return;
    const Vector6d now = sensor_.mean(run_.block_size(), plant_.model());
    for (const std::size_t j : sensor_numbers_) {
      model::Model moved = plant_.model();
      moved.effects[static_cast<std::size_t>(numbers_[j].index)]
          .theta[static_cast<std::size_t>(numbers_[j].component)] += numbers_[j].step;
      const Vector6d change = (sensor_.mean(run_.block_size(), moved) - now) / numbers_[j].step;
      for (int i = 0; i < N; ++i) response_.added()(i, static_cast<Eigen::Index>(j)) = change[axis(i)];
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
      reduced.r = -transition.Gamma(i, i) * block_noise_.mean_force[i] * d_start[i];
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

  void keep(std::size_t b, const Matrix& E, const Matrix& Gamma, const CovarianceGain<N>& K, const Matrix& L_inverse) {
    double* to = reference_->gains.data() + b * RunReference::kMatrices * N * N;
    for (const Matrix* matrix : {&E, &Gamma, &K.nu, &K.d, &K.c, &L_inverse}) {
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
  ResponseState<N> response_;
  ResponseStep<N> response_step_;
  GatheredRows rows_;
  std::array<int, static_cast<std::size_t>(N)> axes_{};
  Matrix H_{Matrix::Identity()};
  std::vector<std::size_t> sensor_numbers_;
  Vector6d bias_{Vector6d::Zero()};
  std::vector<TailDensity> tails_;
  std::array<FollowedScale, static_cast<std::size_t>(N)> scales_{};
  BlockNoise<N> block_noise_;
  Covariance<N> covariance_;
  Vector force_decay_, force_half_;  // over a substep and a half
  Vector rolled_end_{Vector::Zero()}, others_{Vector::Zero()};
  Vector6d nu_{Vector6d::Zero()};
  Vector d_{Vector::Zero()}, c_{Vector::Zero()};
  Columns columns_, nu_columns_, wrenches_;
};

}  // namespace fathom::likelihood
