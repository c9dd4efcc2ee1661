// Factored recursive least squares: forgetting, Bierman rows, Schmidt freezing, honest covariance.
#include "common/identification/recursive.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <string>
#include <utility>

#include "common/base/distributions.hpp"
#include "common/base/error.hpp"
#include "common/identification/bierman.hpp"

namespace fathom::identification {
namespace {

constexpr double kLargestCorrelation = 0.995;  // beyond this the AR(1) factor says more about the sample than the noise
constexpr double kDoubt = 2.0;                 // standard errors of a correlation
constexpr double kStatedFreedom = 3.0;         // of the stated noise: with two a variance has no mean
constexpr double kOverlap = 1.5;               // independent sums that as many overlapping ones of one length are worth

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
  sign_ = ParameterVector::Zero(padded(n));
  for (Eigen::Index i = 0; i < n; ++i) sign_(i) = settings_.signs[static_cast<std::size_t>(i)];
  if (!(settings_.forgetting > 0.0 && settings_.forgetting <= 1.0)) {
    throw InputError("recursive estimator: forgetting must lie in (0, 1]");
  }
  reset();
}

void RecursiveEstimator::reset() {
  const Eigen::Index n = settings_.mean.size();
  state_ = State{};
  const ParameterVector none = ParameterVector::Zero(padded(n));
  state_.estimate = none;
  state_.estimate.head(n) = settings_.mean;
  state_.U = ParameterMatrix::Zero(padded(n), n);
  state_.U.diagonal().setOnes();
  state_.D = none;
  state_.D.head(n) = settings_.sigma.cwiseAbs2();
  state_.derivatives = ParameterVector::Zero(n);
  state_.information = state_.score0 = state_.fourth = state_.together = state_.apart = score_ = none;
  state_.last_scores = state_.last_sums = ParameterMatrix::Zero(padded(n), kTogether);
  count_frozen();
}

void RecursiveEstimator::count_frozen() {
  free_ = ParameterVector::Ones(padded(size()));
  for (Eigen::Index i = 0; i < size(); ++i) free_(i) = state_.frozen[static_cast<std::size_t>(i)] ? 0.0 : 1.0;
  any_frozen_ = !(free_.array() == 1.0).all();
}

void RecursiveEstimator::freeze(int parameter) {
  state_.frozen.at(static_cast<std::size_t>(parameter)) = true;
  count_frozen();
}

void RecursiveEstimator::resume(int parameter) {
  state_.frozen.at(static_cast<std::size_t>(parameter)) = false;
  count_frozen();
  state_.steps_until_check = 0.0;
}

// P <- S P S with a diagonal S: 1/sqrt(forgetting) where a parameter may grow, less where it would pass its cap, 1
// where it is frozen. In factors: U_ij s_i / s_j and D_j s_j^2, so P stays positive whatever happens. As long as
// nothing can have reached a cap, S is a multiple of the identity and U stays as it is.
void RecursiveEstimator::forget() {
  if (settings_.forgetting >= 1.0) return;
  const double growth = 1.0 / settings_.forgetting;
  const Eigen::Index n = size();
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

// One scalar row; then, for frozen parameters, Schmidt's gain: they are not moved, and what the optimal update took
// from their variance is given back.
void RecursiveEstimator::take(const Row& row) {
  const Eigen::Index n = size();
  alignas(32) std::array<double, kMaxParameters> gain;
  const auto [residual, per_alpha] = take_row({.U = state_.U.data(),
                                               .D = state_.D.data(),
                                               .x = state_.estimate.data(),
                                               .score = score_.data(),
                                               .information = state_.information.data(),
                                               .free = free_.data(),
                                               .n = n},
                                              row.h.data(), row.y, row.variance, gain.data());
  if (any_frozen_) {
    ParameterVector v = ParameterVector::Zero(n);
    for (Eigen::Index i = 0; i < n; ++i) {
      if (state_.frozen[static_cast<std::size_t>(i)]) v(i) = gain[static_cast<std::size_t>(i)];
    }
    add_outer(per_alpha, v);
  }

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
  for (Eigen::Index j = size() - 1; j >= 0 && factor > 0.0; --j) {
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
  if (keep < 1.0) {
    state_.information *= keep;
    state_.derivatives *= keep;
  }
  state_.steps = keep * state_.steps + 1.0;
  score_.setZero();
  for (const Row& row : rows) {
    take(row);
    if (row.derivative >= 0 && !state_.frozen[static_cast<std::size_t>(row.derivative)])
      state_.derivatives(row.derivative) += 1.0 / row.variance;
  }
  add_scores({.squares = state_.score0.data(),
              .fourth = state_.fourth.data(),
              .together = state_.together.data(),
              .apart = state_.apart.data(),
              .sum = state_.last_sums.col((state_.oldest + kTogether - 1) % kTogether).data(),
              .oldest_score = state_.last_scores.col(state_.oldest).data(),
              .oldest_sum = state_.last_sums.col(state_.oldest).data(),
              .n = size()},
             score_.data(), keep);
  state_.oldest = (state_.oldest + 1) % kTogether;
}

ParameterMatrix RecursiveEstimator::covariance() const {
  const Eigen::Index n = size();
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
  constexpr std::size_t kFew = 4;
  const Eigen::Index n = size();
  alignas(32) std::array<std::array<double, kMaxParameters>, kFew> columns;
  std::array<Eigen::Index, kFew> held{};
  std::size_t count = 0;
  ParameterVector x = state_.estimate;
  for (std::uint32_t broken = violated(x.data(), sign_.data(), n); broken != 0;) {
    for (; broken != 0; broken &= broken - 1) {
      if (count == kFew) return project_on_signs(unconstrained(), covariance(), settings_.signs);
      held[count] = std::countr_zero(broken);
      covariance_column(state_.U.data(), state_.D.data(), n, held[count], columns[count].data());
      ++count;
    }
    // The multipliers solve A l = -x_held with A the held block of P: symmetric and positive, so no pivots.
    std::array<std::array<double, kFew>, kFew> A;
    std::array<double, kFew> l;
    for (std::size_t r = 0; r < count; ++r) {
      l[r] = -state_.estimate(held[r]);
      for (std::size_t c = 0; c < count; ++c) A[r][c] = columns[c][static_cast<std::size_t>(held[r])];
    }
    for (std::size_t k = 0; k < count; ++k) {
      for (std::size_t r = k + 1; r < count; ++r) {
        const double share = A[r][k] / A[k][k];
        for (std::size_t c = k + 1; c < count; ++c) A[r][c] -= share * A[k][c];
        l[r] -= share * l[k];
      }
    }
    for (std::size_t k = count; k-- > 0;) {
      for (std::size_t c = k + 1; c < count; ++c) l[k] -= A[k][c] * l[c];
      l[k] /= A[k][k];
      if (!(l[k] * sign_(held[k]) >= 0.0)) return project_on_signs(unconstrained(), covariance(), settings_.signs);
    }
    x = state_.estimate;
    for (std::size_t k = 0; k < count; ++k) add_multiple(x.data(), l[k], columns[k].data(), n);
    for (std::size_t k = 0; k < count; ++k) x(held[k]) = 0.0;
    broken = violated(x.data(), sign_.data(), n);
  }
  x.conservativeResize(n);
  return x;
}

// The estimate errs by P times the sum of the scores. White residuals of the stated variance give that sum a variance
// equal to the information; what it really is, is read off the scores: sums of kTogether steps that overlap, which is
// the long-run variance through Bartlett's window (Newey & West 1987; compare Grauer & Morelli 2016). This sees the
// colour of residual and regressor together, noise that swings as well as noise that lasts; where one sum resembles the
// one before it beyond doubt, their memory is longer still, and goes on as AR(1) of such sums. The prior's share of the
// information is taken at its word. So many scores tell a noise so well (Student). Where they are smaller than stated,
// the statement counts as if it were the least that has a mean: a few quiet seconds prove little, and what no score
// shows keeps some room.
ParameterVector RecursiveEstimator::inflation(const ParameterMatrix& P) const {
  const Eigen::Index n = size();
  const ParameterVector prior = settings_.sigma.cwiseAbs2().cwiseInverse();
  ParameterVector factor = ParameterVector::Ones(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const double squares = state_.score0(i), information = state_.information(i);
    if (!(squares > 0.0 && information > 0.0)) continue;
    // Gauss's fourth moment is three variances squared: of scores all alike in size this is their number.
    const double alike = state_.fourth(i) > 0.0 ? 3.0 * squares * squares / state_.fourth(i) : 1.0;
    const double count = std::min(alike, state_.steps);
    const double freedom = kOverlap * count / kTogether;
    double seen = state_.together(i) / (kTogether * information);
    if (seen > 0.0) {
      const double resembles = state_.apart(i) / state_.together(i) - kDoubt / std::sqrt(freedom);
      const double rho = std::clamp(resembles, 0.0, kLargestCorrelation);
      seen *= (1.0 + rho) / (1.0 - rho);
    }
    if (seen < 1.0) seen = (kStatedFreedom + freedom * seen) / (kStatedFreedom + freedom);
    seen *= student_widening(kStatedFreedom + freedom);
    // Of P that much is the prior's: P = P (1 / sigma^2 + information) P.
    const double told = std::min(1.0, P.col(i).cwiseAbs2().dot(prior) / P(i, i));
    factor(i) = told + (1.0 - told) * seen;
  }
  return factor;
}

RecursiveReport RecursiveEstimator::report() const {
  RecursiveReport report;
  report.covariance = covariance();
  const Eigen::Index n = size();
  report.estimate = project_on_signs(unconstrained(), report.covariance, settings_.signs);
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
  const auto full = [&](const ParameterVector& v) { return v.size() == padded(n); };
  const auto last = [&](const ParameterMatrix& m) { return m.rows() == padded(n) && m.cols() == kTogether; };
  const bool fits = full(state.estimate) && full(state.D) && state.U.rows() == padded(n) && state.U.cols() == n &&
                    state.derivatives.size() == n && full(state.information) && full(state.score0) &&
                    full(state.fourth) && full(state.together) && full(state.apart) && last(state.last_scores) &&
                    last(state.last_sums) && state.oldest >= 0 && state.oldest < kTogether;
  if (!fits) throw InputError("recursive estimator: saved state is of another number of parameters");
  if (!state.estimate.allFinite() || !state.U.allFinite() || !state.D.allFinite() ||
      !(state.D.head(n).minCoeff() > 0.0)) {
    throw InputError("recursive estimator: saved state is not finite or its covariance is not positive");
  }
  state_ = state;
  count_frozen();
}

}  // namespace fathom::identification
