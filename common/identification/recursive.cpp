// Factored recursive least squares: forgetting, Bierman rows, Schmidt freezing, honest covariance.
#include "common/identification/recursive.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "common/base/error.hpp"
#include "common/identification/bierman.hpp"

namespace fathom::identification {
namespace {

constexpr double kLargestCorrelation = 0.995;  // beyond this the AR(1) factor says more about the sample than the noise
constexpr double kDoubtOfRatio = 16.0;         // four standard errors, squared
constexpr double kStatedScores = 20.0;  // independent ones that the stated noise is worth: a third of it in doubt

}  // namespace

RecursiveEstimator::RecursiveEstimator(RecursiveSettings settings) : settings_(std::move(settings)) {
  const Eigen::Index n = settings_.mean.size();
  if (settings_.cap.size() == 0) settings_.cap = settings_.sigma;
  if (n == 0 || settings_.sigma.size() != n || settings_.cap.size() != n) {
    throw InputError("recursive estimator: prior mean, sigma and cap must have one entry per parameter");
  }
  for (Eigen::Index i = 0; i < n; ++i) {
    if (!std::isfinite(settings_.mean(i)) || !(settings_.sigma(i) > 0.0) || !std::isfinite(settings_.sigma(i))) {
      throw InputError("recursive estimator: prior of parameter " + std::to_string(i) +
                       " needs a finite mean and sigma > 0");
    }
    settings_.cap(i) = std::max(settings_.cap(i), settings_.sigma(i));
  }
  sign_.resize(n);
  for (Eigen::Index i = 0; i < n; ++i) sign_(i) = settings_.signs[static_cast<std::size_t>(i)];
  if (!(settings_.forgetting > 0.0 && settings_.forgetting <= 1.0)) {
    throw InputError("recursive estimator: forgetting must lie in (0, 1]");
  }
  reset();
}

void RecursiveEstimator::reset() {
  const Eigen::Index n = settings_.mean.size();
  state_ = State{};
  state_.estimate = settings_.mean;
  state_.U = ParameterMatrix::Zero(padded(n), n);
  state_.U.diagonal().setOnes();
  state_.D = ParameterVector::Zero(padded(n));
  state_.D.head(n) = settings_.sigma.cwiseAbs2();
  state_.information = ParameterVector::Zero(n);
  state_.derivatives = ParameterVector::Zero(n);
  state_.score0 = ParameterVector::Zero(n);
  state_.score1 = ParameterVector::Zero(n);
  state_.score2 = ParameterVector::Zero(n);
  state_.fourth = ParameterVector::Zero(n);
  state_.last_score = state_.score_before = ParameterVector::Zero(n);
  any_frozen_ = false;
  score_ = score_square_ = ParameterVector::Zero(n);
}

void RecursiveEstimator::freeze(int parameter) {
  state_.frozen.at(static_cast<std::size_t>(parameter)) = true;
  any_frozen_ = true;
}

void RecursiveEstimator::resume(int parameter) {
  state_.frozen.at(static_cast<std::size_t>(parameter)) = false;
  any_frozen_ = std::any_of(state_.frozen.begin(), state_.frozen.end(), [](bool f) { return f; });
  state_.steps_until_check = 0.0;
}

// P <- S P S with a diagonal S: 1/sqrt(forgetting) where a parameter may grow, less where it would pass its cap, 1
// where it is frozen. In factors: U_ij s_i / s_j and D_j s_j^2, so P stays positive whatever happens. As long as
// nothing can have reached a cap, S is a multiple of the identity and U stays as it is.
void RecursiveEstimator::forget() {
  if (settings_.forgetting >= 1.0) return;
  const double growth = 1.0 / settings_.forgetting;
  const Eigen::Index n = state_.estimate.size();
  if (!any_frozen_ && state_.steps_until_check >= 1.0) {
    state_.D *= growth;
    state_.steps_until_check -= 1.0;
    return;
  }
  std::array<double, kMaxParameters> s{};
  double steps = 1e6;
  for (Eigen::Index j = 0; j < n; ++j) {
    double variance = state_.D(j);
    for (Eigen::Index k = j + 1; k < n; ++k) variance += state_.U(j, k) * state_.U(j, k) * state_.D(k);
    const double room = settings_.cap(j) * settings_.cap(j) / variance;
    const double scale = state_.frozen[static_cast<std::size_t>(j)] ? 1.0 : std::clamp(room, 1.0, growth);
    s[static_cast<std::size_t>(j)] = std::sqrt(scale);
    steps = std::min(steps, std::floor(std::log(room / scale) / std::log(growth)));
  }
  for (Eigen::Index j = 0; j < n; ++j) {
    const double s_j = s[static_cast<std::size_t>(j)];
    for (Eigen::Index i = 0; i < j; ++i) state_.U(i, j) *= s[static_cast<std::size_t>(i)] / s_j;
    state_.D(j) *= s_j * s_j;
  }
  state_.steps_until_check = std::max(0.0, steps);
}

// One scalar row; then, for frozen parameters, Schmidt's
// gain: they are not moved, and what the optimal update took from their variance is given back.
void RecursiveEstimator::take(const Row& row) {
  const Eigen::Index n = state_.estimate.size();
  alignas(32) std::array<double, kMaxParameters> h, gain;
  std::copy_n(row.h.data(), n, h.data());
  std::fill(h.begin() + n, h.begin() + state_.U.rows(), 0.0);
  const double innovation = row.y - row.h.dot(state_.estimate);
  const double per_variance = 1.0 / row.variance;
  const double per_alpha = bierman_update(state_.U.data(), state_.D.data(), h.data(), n, row.variance, gain.data());

  const double step = innovation * per_alpha;
  if (!any_frozen_) {
    state_.estimate += step * Eigen::Map<const Eigen::VectorXd, Eigen::Aligned32>(gain.data(), n);
  } else {
    ParameterVector v = ParameterVector::Zero(n);
    for (Eigen::Index i = 0; i < n; ++i) {
      if (state_.frozen[static_cast<std::size_t>(i)]) {
        v(i) = gain[static_cast<std::size_t>(i)];
      } else {
        state_.estimate(i) += gain[static_cast<std::size_t>(i)] * step;
      }
    }
    add_outer(per_alpha, v);
  }

  // The innovation has variance alpha; scaled by sqrt(variance / alpha) it has the row's, from the first step on.
  const double residual = innovation * std::sqrt(row.variance * per_alpha);
  const double weight = residual * per_variance;
  score_ += weight * row.h;
  state_.information.array() += per_variance * row.h.array().square();

  AxisStatistics& axis = state_.axes[static_cast<std::size_t>(row.axis)];
  const double off = residual - axis.mean;
  const double product = off * (axis.last - axis.mean);
  axis.weight = settings_.forgetting * axis.weight + 1.0;
  const double share = 1.0 / axis.weight;
  axis.mean += share * off;
  axis.variance = (1.0 - share) * (axis.variance + share * off * off);
  axis.covariance += axis.weight > 1.0 ? share * (product - axis.covariance) : 0.0;
  axis.last = residual;
  ++state_.updates;
}

// U D U' += factor v v' (Agee & Turner 1972); v is used up.
void RecursiveEstimator::add_outer(double factor, ParameterVector& v) {
  for (Eigen::Index j = state_.estimate.size() - 1; j >= 0 && factor > 0.0; --j) {
    if (v(j) == 0.0) continue;
    const double before = state_.D(j);
    const double after = before + factor * v(j) * v(j);
    const double b = factor * v(j) / after;
    for (Eigen::Index i = 0; i < j; ++i) {
      v(i) -= v(j) * state_.U(i, j);
      state_.U(i, j) += b * v(i);
    }
    factor *= before / after;
    state_.D(j) = after;
  }
}

void RecursiveEstimator::step(std::span<const Row> rows) {
  forget();
  const double keep = settings_.forgetting;
  state_.information *= keep;
  state_.derivatives *= keep;
  score_.setZero();
  for (const Row& row : rows) {
    take(row);
    if (row.derivative >= 0 && !state_.frozen[static_cast<std::size_t>(row.derivative)])
      state_.derivatives(row.derivative) += 1.0 / row.variance;
  }
  score_square_ = score_.cwiseAbs2();
  state_.score0 = keep * state_.score0 + score_square_;
  state_.fourth = keep * state_.fourth + score_square_.cwiseAbs2();
  state_.score1 = keep * state_.score1 + score_.cwiseProduct(state_.last_score);
  state_.score2 = keep * state_.score2 + score_.cwiseProduct(state_.score_before);
  state_.score_before.swap(state_.last_score);
  state_.last_score.swap(score_);
}

ParameterMatrix RecursiveEstimator::covariance() const {
  const Eigen::Index n = state_.estimate.size();
  ParameterMatrix P = ParameterMatrix::Zero(n, n);
  for (Eigen::Index j = 0; j < n; ++j) {
    for (Eigen::Index k = j; k < n; ++k) {
      P.col(j).head(j + 1) += (state_.D(k) * state_.U(j, k)) * state_.U.col(k).head(j + 1);
    }
    P.row(j).head(j) = P.col(j).head(j).transpose();
  }
  return P;
}

// A few violated signs are the usual case. The point nearest to the estimate where all of them are zero needs their
// columns of P alone; when it obeys the others, and every one of them pushes the right way, it is the solution.
ParameterVector RecursiveEstimator::projected() const {
  constexpr Eigen::Index kFew = 4;
  const Eigen::Index n = state_.estimate.size();
  std::array<Eigen::Index, kFew> held{};
  alignas(32) std::array<std::array<double, kMaxParameters>, kFew> columns;
  Eigen::Index count = 0, ready = 0;
  ParameterVector x = state_.estimate;
  if ((x.array() * sign_.array()).minCoeff() >= 0.0) return x;
  while (true) {
    for (Eigen::Index i = 0; i < n; ++i) {
      if (x(i) * sign_(i) >= 0.0) continue;
      if (count == kFew) return project_on_signs(state_.estimate, covariance(), settings_.signs);
      held[static_cast<std::size_t>(count++)] = i;
    }
    if (count == ready) return x;
    for (; ready < count; ++ready) {
      covariance_column(state_.U.data(), state_.D.data(), n, held[static_cast<std::size_t>(ready)],
                        columns[static_cast<std::size_t>(ready)].data());
    }
    // The multipliers solve A l = -x_held with A the held block of P: symmetric and positive, so no pivots.
    std::array<std::array<double, kFew>, kFew> A;
    std::array<double, kFew> l;
    for (std::size_t r = 0; r < static_cast<std::size_t>(count); ++r) {
      l[r] = -state_.estimate(held[r]);
      for (std::size_t c = 0; c < static_cast<std::size_t>(count); ++c)
        A[r][c] = columns[c][static_cast<std::size_t>(held[r])];
    }
    for (std::size_t k = 0; k < static_cast<std::size_t>(count); ++k) {
      for (std::size_t r = k + 1; r < static_cast<std::size_t>(count); ++r) {
        const double share = A[r][k] / A[k][k];
        for (std::size_t c = k + 1; c < static_cast<std::size_t>(count); ++c) A[r][c] -= share * A[k][c];
        l[r] -= share * l[k];
      }
    }
    for (std::size_t k = static_cast<std::size_t>(count); k-- > 0;) {
      for (std::size_t c = k + 1; c < static_cast<std::size_t>(count); ++c) l[k] -= A[k][c] * l[c];
      l[k] /= A[k][k];
      if (!(l[k] * sign_(held[k]) >= 0.0)) return project_on_signs(state_.estimate, covariance(), settings_.signs);
    }
    x = state_.estimate;
    for (std::size_t k = 0; k < static_cast<std::size_t>(count); ++k)
      x += l[k] * Eigen::Map<const Eigen::VectorXd, Eigen::Aligned32>(columns[k].data(), n);
    for (std::size_t k = 0; k < static_cast<std::size_t>(count); ++k) x(held[k]) = 0.0;
  }
}

// The estimate errs by P times the sum of the scores. White residuals of the stated variance give that sum a variance
// equal to the information; what it really is, is read off the scores: their size, and their correlation over one step
// and two taken as ARMA(1, 1) (the effective sample size; compare Grauer & Morelli 2016): windows that overlap make the
// one, residuals with a memory the other. This sees the colour of residual and regressor together. The prior's share of
// the information is taken at its word. Where residuals are smaller than stated, the statement counts as if so many
// independent scores had told it: a few quiet seconds prove little.
ParameterVector RecursiveEstimator::inflation(const ParameterMatrix& P) const {
  const Eigen::Index n = state_.estimate.size();
  const ParameterVector prior = settings_.sigma.cwiseAbs2().cwiseInverse();
  ParameterVector factor = ParameterVector::Ones(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const double squares = state_.score0(i), information = state_.information(i);
    if (!(squares > 0.0 && information > 0.0)) continue;
    // Gauss's fourth moment is three variances squared: of scores all alike in size this is their number.
    const double count = state_.fourth(i) > 0.0 ? 3.0 * squares * squares / state_.fourth(i) : 1.0;
    const double rho = std::clamp(state_.score1(i) / squares, 0.0, kLargestCorrelation);
    // Two correlations, each known to 1 / sqrt(count): where the first is no more than that, AR(1).
    const double doubt = kDoubtOfRatio / count;
    const double fades = rho * (state_.score2(i) / squares + doubt) / (rho * rho + doubt);
    const double longer = 1.0 + 2.0 * rho / (1.0 - std::clamp(fades, 0.0, kLargestCorrelation));
    double seen = squares * longer / information;
    const double scores = count / longer;
    if (seen < 1.0) seen = (kStatedScores + scores * seen) / (kStatedScores + scores);
    // Of P that much is the prior's: P = P (1 / sigma^2 + information) P.
    const double told = std::min(1.0, P.col(i).cwiseAbs2().dot(prior) / P(i, i));
    factor(i) = told + (1.0 - told) * seen;
  }
  return factor;
}

RecursiveReport RecursiveEstimator::report() const {
  RecursiveReport report;
  report.covariance = covariance();
  report.estimate = project_on_signs(state_.estimate, report.covariance, settings_.signs);
  const Eigen::Index n = state_.estimate.size();
  for (Eigen::Index i = 0; i < n; ++i) {
    report.active[static_cast<std::size_t>(i)] =
        settings_.signs[static_cast<std::size_t>(i)] != 0 && report.estimate(i) == 0.0;
  }
  report.inflation = inflation(report.covariance);
  const ParameterVector widen = report.inflation.cwiseSqrt();
  for (Eigen::Index j = 0; j < n; ++j) {
    for (Eigen::Index i = 0; i < n; ++i) report.covariance(i, j) *= widen(i) * widen(j);
  }
  report.sigma = report.covariance.diagonal().cwiseSqrt();
  return report;
}

void RecursiveEstimator::restore(const State& state) {
  const Eigen::Index n = settings_.mean.size();
  const bool fits = state.estimate.size() == n && state.D.size() == padded(n) && state.U.rows() == padded(n) &&
                    state.U.cols() == n && state.information.size() == n && state.derivatives.size() == n &&
                    state.score0.size() == n && state.score1.size() == n && state.score2.size() == n &&
                    state.fourth.size() == n && state.last_score.size() == n && state.score_before.size() == n;
  if (!fits) throw InputError("recursive estimator: saved state is of another number of parameters");
  if (!state.estimate.allFinite() || !state.U.allFinite() || !state.D.allFinite() ||
      !(state.D.head(n).minCoeff() > 0.0)) {
    throw InputError("recursive estimator: saved state is not finite or its covariance is not positive");
  }
  state_ = state;
  any_frozen_ = std::any_of(state_.frozen.begin(), state_.frozen.end(), [](bool f) { return f; });
}

}  // namespace fathom::identification
