#include "common/diagnosis/whiteness.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>

#include "common/diagnosis/prediction.hpp"

namespace fathom::diagnosis {
namespace {

constexpr double kLongestLag = 2.0;     // s, of the whiteness test
constexpr double kMemorySearch = 30.0;  // s
constexpr double kBlock = 20.0;         // s, of data held out together
constexpr int kFolds = 5;

/// Upper tail of chi-square by Wilson and Hilferty's cube root (1931): within 1e-3 for 3 and more degrees of freedom.
double chi_square_tail(double x, double dof) {
  if (x <= 0.0) return 1.0;
  const double z = (std::cbrt(x / dof) - (1.0 - 2.0 / (9.0 * dof))) / std::sqrt(2.0 / (9.0 * dof));
  return 0.5 * std::erfc(z / std::sqrt(2.0));
}

std::vector<double> axis_series(std::span<const Vector6d> residual, Eigen::Index axis) {
  std::vector<double> series;
  series.reserve(residual.size());
  for (const Vector6d& wrench : residual) series.push_back(wrench[axis]);
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

/// A sample, with the velocity that the model predicts there: the measured one carries the noise that is also in the
/// residual, and noise with a memory would go with itself.
struct Moment {
  const Trial& trial;
  std::size_t k;
  const std::array<double, 6>& nu;
};

using Velocities = std::vector<std::array<double, 6>>;
using Features = std::function<Eigen::Vector4d(const Moment&, int axis)>;

struct Suspect {
  std::string name;
  bool (*seen)(const Trial&);
  Features features;
};

std::vector<Suspect> suspects(const model::Model& model) {
  const model::Allocation allocation = model.allocation;
  const auto always = [](const Trial&) { return true; };
  return {
      {"position", [](const Trial& t) { return t.observed.position; },
       [](const Moment& at, int) {
         const Eigen::Vector3d& p = at.trial.p_WB[at.k];
         return Eigen::Vector4d(p.x(), p.y(), p.x() * p.y(), p.head<2>().squaredNorm());
       }},
      {"depth", [](const Trial& t) { return t.observed.position; },
       [](const Moment& at, int) {
         const double z = at.trial.p_WB[at.k].z();
         return Eigen::Vector4d(z, z * z, 0.0, 0.0);
       }},
      {"heading", [](const Trial& t) { return t.observed.attitude; },
       [](const Moment& at, int) {
         const double psi = euler_from_rotation(at.trial.q_WB[at.k].toRotationMatrix()).z();
         return Eigen::Vector4d(std::sin(psi), std::cos(psi), std::sin(2.0 * psi), std::cos(2.0 * psi));
       }},
      {"speed", always,
       [](const Moment& at, int axis) {
         const auto& nu = at.nu;
         const double v = nu[static_cast<std::size_t>(axis)];
         return Eigen::Vector4d(v, std::abs(v), v * std::abs(v), nu[0] * nu[0] + nu[1] * nu[1] + nu[2] * nu[2]);
       }},
      {"thrust", always,
       [allocation](const Moment& at, int axis) {
         const auto& input = at.trial.input[at.k];
         const Vector6d tau = allocation * input;
         return Eigen::Vector4d(tau[axis], std::abs(tau[axis]), input.cwiseAbs().sum(), 0.0);
       }},
      {"voltage", [](const Trial& t) { return !t.voltage.empty(); },
       [allocation](const Moment& at, int axis) {
         const double tau = (allocation * at.trial.input[at.k])[axis], voltage = at.trial.voltage[at.k];
         return Eigen::Vector4d(voltage, voltage * tau, 0.0, 0.0);
       }},
      {"time", always,
       [](const Moment& at, int) {
         const double t = at.trial.t[at.k];
         return Eigen::Vector4d(t, t * t, 0.0, 0.0);
       }},
  };
}

/// Share of variance that a linear function of the features explains on folds that did not set it.
double held_out_share(const Suspect& suspect, std::span<const Trial> trials,
                      std::span<const std::vector<Vector6d>> residuals, std::span<const Velocities> predicted,
                      int axis) {
  using Matrix5d = Eigen::Matrix<double, 5, 5>;
  using Vector5d = Eigen::Matrix<double, 5, 1>;
  std::array<Matrix5d, kFolds> normal;
  std::array<Vector5d, kFolds> right;
  std::array<double, kFolds> square{}, sum{}, count{};
  normal.fill(Matrix5d::Zero());
  right.fill(Vector5d::Zero());
  std::size_t block_offset = 0;
  for (std::size_t r = 0; r < trials.size(); ++r) {
    const Trial& trial = trials[r];
    if (!suspect.seen(trial)) continue;
    for (std::size_t k = 0; k < trial.size(); ++k) {
      const double y = residuals[r][k][axis];
      if (!std::isfinite(y)) continue;
      const std::size_t fold = (block_offset + static_cast<std::size_t>((trial.t[k] - trial.t[0]) / kBlock)) % kFolds;
      Vector5d x;
      x << 1.0, suspect.features({trial, k, predicted[r][k]}, axis);
      if (!x.allFinite()) continue;
      normal[fold] += x * x.transpose();
      right[fold] += x * y;
      square[fold] += y * y;
      sum[fold] += y;
      count[fold] += 1.0;
    }
    block_offset += 1 + static_cast<std::size_t>((trial.t.back() - trial.t[0]) / kBlock);
  }
  double error = 0.0, total = 0.0;
  for (std::size_t fold = 0; fold < kFolds; ++fold) {
    if (count[fold] < 1.0) continue;
    Matrix5d others = Matrix5d::Zero();
    Vector5d target = Vector5d::Zero();
    double other_sum = 0.0, other_count = 0.0;
    for (std::size_t f = 0; f < kFolds; ++f) {
      if (f == fold) continue;
      others += normal[f];
      target += right[f];
      other_sum += sum[f];
      other_count += count[f];
    }
    if (other_count < 1.0) return 0.0;
    others.diagonal() *= 1.0 + 1e-6;
    others.diagonal().array() += 1e-12;
    const Vector5d beta = others.ldlt().solve(target);
    error += square[fold] - 2.0 * beta.dot(right[fold]) + beta.dot(normal[fold] * beta);
    const double mean = other_sum / other_count;
    total += square[fold] - 2.0 * mean * sum[fold] + mean * mean * count[fold];
  }
  return total > 0.0 ? 1.0 - error / total : 0.0;
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

std::vector<AxisWhiteness> whiteness(const model::Model& model, std::span<const Trial> trials,
                                     std::span<const std::vector<Vector6d>> residuals) {
  std::vector<AxisWhiteness> rows;
  for (Eigen::Index axis = 0; axis < 6; ++axis) {
    const auto a = static_cast<std::size_t>(axis);
    if (!model.vehicle->dof[a]) continue;
    AxisWhiteness row{.axis = model::kAxisNames[a]};
    double weight = 0.0, memory = 0.0, residual_square = 0.0, applied_square = 0.0, statistic_p = 1.0;
    for (std::size_t r = 0; r < trials.size(); ++r) {
      const std::vector<double> series = axis_series(residuals[r], axis);
      const Moments m = moments(series);
      if (m.count < 10.0) continue;
      const auto lags = static_cast<std::size_t>(kLongestLag / trials[r].dt);
      const auto longest = std::min(series.size() - 1, static_cast<std::size_t>(kMemorySearch / trials[r].dt));
      const std::vector<double> rho = autocorrelation(series, longest);
      statistic_p = std::min(statistic_p, ljung_box_p(std::span{rho}.first(std::min(lags + 1, rho.size())), m.count));
      double area = 0.5 * trials[r].dt;  // integral of rho up to its first zero
      for (std::size_t lag = 1; lag < rho.size() && rho[lag] > 0.0; ++lag) area += rho[lag] * trials[r].dt;
      memory += area * m.count;
      weight += m.count;
      residual_square += m.variance * m.count;
      std::vector<double> applied;
      for (const auto& input : trials[r].input) applied.push_back((model.allocation * input)[axis]);
      applied_square += moments(applied).variance * m.count;
    }
    row.p_value = statistic_p;
    row.autocorrelation_time_s = weight > 0.0 ? memory / weight : 0.0;
    row.explained = applied_square > 0.0 ? 1.0 - residual_square / applied_square : 0.0;
    rows.push_back(row);
  }
  return rows;
}

std::vector<Association> associations(const model::Model& model, std::span<const Trial> trials,
                                      std::span<const std::vector<Vector6d>> residuals, double smallest) {
  std::vector<Association> found;
  std::vector<Velocities> predicted;
  for (const Trial& trial : trials) {
    predicted.push_back(predict_anew(model, trial, restarts(trial)));
    for (std::size_t k = 0; k < trial.size(); ++k) {  // nothing moves along an axis that is not simulated
      for (std::size_t axis = 0; axis < 6; ++axis) {
        if (!model.vehicle->dof[axis]) predicted.back()[k][axis] = 0.0;
      }
    }
  }
  for (const Suspect& suspect : suspects(model)) {
    for (int axis = 0; axis < 6; ++axis) {
      if (!model.vehicle->dof[static_cast<std::size_t>(axis)]) continue;
      const double share = held_out_share(suspect, trials, residuals, predicted, axis);
      if (share > smallest) found.push_back({model::kAxisNames[static_cast<std::size_t>(axis)], suspect.name, share});
    }
  }
  std::stable_sort(found.begin(), found.end(),
                   [](const Association& a, const Association& b) { return a.share > b.share; });
  return found;
}

}  // namespace fathom::diagnosis
