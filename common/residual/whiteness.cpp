#include "common/residual/whiteness.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/residual/force_residual.hpp"

namespace fathom::residual {
namespace {

constexpr double kLongestLag = 10.0;    // s, of the whiteness test
constexpr double kMemorySearch = 30.0;  // s
constexpr double kSameStep = 0.01;      // of steps of two runs that are one

/// Upper tail of chi-square by Wilson and Hilferty's cube root (1931): within 1e-3 for 3 and more degrees of freedom.
double chi_square_tail(double x, double dof) {
  if (x <= 0.0) return 1.0;
  const double z = (std::cbrt(x / dof) - (1.0 - 2.0 / (9.0 * dof))) / std::sqrt(2.0 / (9.0 * dof));
  return 0.5 * std::erfc(z / std::sqrt(2.0));
}

/// Samples that share no measurement: nearer ones are alike because each is a mean.
std::vector<double> axis_series(std::span<const Vector6d> residual, Eigen::Index axis, std::size_t span) {
  std::vector<double> series;
  for (std::size_t k = span / 2; k < residual.size(); k += span) series.push_back(residual[k][axis]);
  return series;
}

struct Moments {
  double count{}, mean{}, variance{};
};

Moments moments(std::span<const double> series) {
  Moments m;
  double sum = 0.0, square = 0.0;
  for (const double value : series) {
    if (!std::isfinite(value)) continue;
    m.count += 1.0;
    sum += value;
    square += value * value;
  }
  if (m.count > 0.0) {
    m.mean = sum / m.count;
    m.variance = std::max(square / m.count - m.mean * m.mean, 0.0);
  }
  return m;
}

}  // namespace

std::vector<double> autocorrelation(std::span<const double> series, std::size_t most) {
  const Moments m = moments(series);
  std::vector<double> rho(most + 1, 0.0);
  if (m.variance <= 0.0) return rho;
  for (std::size_t lag = 0; lag <= most && lag < series.size(); ++lag) {
    double sum = 0.0, count = 0.0;
    for (std::size_t k = lag; k < series.size(); ++k) {
      const double product = (series[k] - m.mean) * (series[k - lag] - m.mean);
      if (!std::isfinite(product)) continue;
      sum += product;
      count += 1.0;
    }
    rho[lag] = count > 0.0 ? sum / count / m.variance : 0.0;
  }
  return rho;
}

double ljung_box_p(std::span<const double> rho, double count) {
  double statistic = 0.0, lags = 0.0;
  for (std::size_t lag = 1; lag < rho.size() && static_cast<double>(lag) < count; ++lag) {
    // autocorrelation() divides by the pairs at each lag, the test's original by all samples: hence a factor, not a
    // divisor.
    statistic += rho[lag] * rho[lag] * (count - static_cast<double>(lag));
    lags += 1.0;
  }
  return lags > 0.0 ? chi_square_tail((count + 2.0) / count * statistic, lags) : 1.0;
}

double swing_period(std::span<const double> rho, double step, double count) {
  constexpr double kLeast = 0.2;                    // of the variance: less is of no use as a hint
  constexpr double kBeyond = 3.0;                   // standard errors
  constexpr double kEarliest = 1.5, kLatest = 3.0;  // of the crest over the trough: a band of frequencies blurs twice
  double squares = 0.5;
  std::size_t trough = 0, crest = 0;
  for (std::size_t lag = 1; lag + 1 < rho.size(); ++lag) {
    const double error = std::sqrt(2.0 * squares / count);
    squares += rho[lag] * rho[lag];
    const double size = std::abs(rho[lag]);
    if (size < kLeast || size < kBeyond * error) continue;
    const bool low = rho[lag] <= rho[lag - 1] && rho[lag] < rho[lag + 1];
    const bool high = rho[lag] >= rho[lag - 1] && rho[lag] > rho[lag + 1];
    if (trough == 0 && low && rho[lag] < 0.0) trough = lag;
    if (trough == 0 || !high || rho[lag] < 0.0) continue;
    crest = lag;
    break;
  }
  const auto ratio = static_cast<double>(crest) / static_cast<double>(std::max<std::size_t>(trough, 1));
  if (crest == 0 || ratio < kEarliest || ratio > kLatest) return std::numeric_limits<double>::quiet_NaN();
  // The crest lies between lags: a parabola through three of them.
  const double bend = rho[crest - 1] - 2.0 * rho[crest] + rho[crest + 1];
  const double off = bend < 0.0 ? 0.5 * (rho[crest - 1] - rho[crest + 1]) / bend : 0.0;
  return (static_cast<double>(crest) + off) * step;
}

std::vector<AxisWhiteness> whiteness(const model::Model& model, std::span<const Trial> trials,
                                     std::span<const std::vector<Vector6d>> residuals) {
  std::vector<AxisWhiteness> rows;
  const auto inertia = [&](Eigen::Index axis) { return model.theta[model::index(model::BaseParameter::m_X) + axis]; };
  for (Eigen::Index axis = 0; axis < 6; ++axis) {
    const auto a = static_cast<std::size_t>(axis);
    if (!model.vehicle->dof[a]) continue;
    AxisWhiteness row{.axis = model::kAxisNames[a]};
    double weight = 0.0, memory = 0.0, residual_square = 0.0, applied_square = 0.0, statistic_p = 1.0;
    double noise_square = 0.0, pooled_step = 0.0;
    std::vector<double> pooled, pooled_weight;  // autocorrelation of runs sampled alike, times their samples
    for (std::size_t r = 0; r < trials.size(); ++r) {
      const std::size_t span = residual_span(trials[r].dt);
      const double step = static_cast<double>(span) * trials[r].dt;
      const std::vector<double> series = axis_series(residuals[r], axis, span);
      const Moments m = moments(series);
      if (m.count < 10.0) continue;
      const auto lags = static_cast<std::size_t>(kLongestLag / step);
      const auto longest = std::min(series.size() - 1, static_cast<std::size_t>(kMemorySearch / step));
      const std::vector<double> rho = autocorrelation(series, longest);
      statistic_p = std::min(statistic_p, ljung_box_p(std::span{rho}.first(std::min(lags + 1, rho.size())), m.count));
      if (pooled.empty()) pooled_step = step;
      if (std::abs(step - pooled_step) < kSameStep * pooled_step) {
        pooled.resize(std::max(pooled.size(), rho.size()), 0.0);
        pooled_weight.resize(pooled.size(), 0.0);
        for (std::size_t lag = 0; lag < rho.size(); ++lag) {
          pooled[lag] += m.count * rho[lag];
          pooled_weight[lag] += m.count;
        }
      }
      double area = 0.5 * step;  // integral of rho up to its first zero
      for (std::size_t lag = 1; lag < rho.size() && rho[lag] > 0.0; ++lag) area += rho[lag] * step;
      memory += area * m.count;
      weight += m.count;
      residual_square += m.variance * m.count;
      noise_square += std::pow(inertia(axis) * trials[r].nu_sigma[axis] * slope_noise(trials[r].dt), 2) * m.count;
      std::vector<double> applied;
      for (const auto& input : trials[r].input) applied.push_back((model.allocation * input)[axis]);
      applied_square += moments(applied).variance * m.count;
    }
    if (weight == 0.0) continue;
    row.p_value = std::min(statistic_p * static_cast<double>(trials.size()), 1.0);  // the least of so many
    row.autocorrelation_time_s = memory / weight;
    for (std::size_t lag = 0; lag < pooled.size(); ++lag) pooled[lag] /= pooled_weight[lag];
    if (row.p_value < kNotRandom && !pooled.empty())
      row.swing_period_s = swing_period(pooled, pooled_step, pooled_weight.front());
    row.explained =
        applied_square > 0.0 ? 1.0 - residual_square / applied_square : std::numeric_limits<double>::quiet_NaN();
    if (applied_square > 0.0) row.noise = noise_square / applied_square;
    row.applied_rms = std::sqrt(applied_square / weight);
    rows.push_back(row);
  }
  return rows;
}

}  // namespace fathom::residual
