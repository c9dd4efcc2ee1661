// Block means, central differences, one ridge regression over the translational axes, one periodogram.
#include "common/model/tones.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "common/base/factors.hpp"
#include "common/model/dynamics.hpp"
#include "common/model/regressor.hpp"
#include "common/samples/trial.hpp"

namespace fathom::model {
namespace {

constexpr double kBlock = 0.25;          // s: waves that move a vehicle have periods above 1 s
constexpr double kLowest = 0.15;         // rad/s: slower swings are drift
constexpr double kHighest = 6.0;         // rad/s
constexpr double kShortestRun = 20;      // s
constexpr std::size_t kNeighbours = 30;  // lines to each side

struct Blocks {
  std::vector<double> t;
  std::vector<Vector6d> nu, tau;
  std::vector<Eigen::Matrix3d> R_WB;
};

Blocks block_means(const Trial& trial, const Allocation& allocation) {
  const auto length = std::max<std::size_t>(1, static_cast<std::size_t>(std::lround(kBlock / trial.dt)));
  Blocks blocks;
  for (std::size_t from = 0; from + length <= trial.size(); from += length) {
    Vector6d nu = Vector6d::Zero(), tau = Vector6d::Zero();
    for (std::size_t k = from; k < from + length; ++k) {
      nu += trial.nu[k];
      tau += allocation * trial.input[k];
    }
    const auto n = static_cast<double>(length);
    blocks.t.push_back(0.5 * (trial.t[from] + trial.t[from + length - 1]));
    blocks.nu.emplace_back(nu / n);
    blocks.tau.emplace_back(tau / n);
    blocks.R_WB.push_back(trial.q_WB[from + length / 2].toRotationMatrix());
  }
  return blocks;
}

/// Forces in W that the base model cannot explain.
std::vector<Eigen::Vector3d> left_over(const Vehicle& vehicle, const Blocks& blocks) {
  BaseTheta sigma = BaseTheta::Zero();
  const BaseTheta mean = nominal_model(vehicle, true).theta;
  for (std::size_t i = 0; i < vehicle.parameters.size(); ++i) {
    if (const auto parameter = parameter_from_name(vehicle.parameters[i])) {
      sigma[index(*parameter)] = vehicle.priors[i].sigma;
    }
  }
  using Normal = Eigen::Matrix<double, kBaseParameterCount, kBaseParameterCount>;
  Normal normal = Normal::Identity();
  BaseTheta right = BaseTheta::Zero();
  std::vector<Eigen::Matrix<double, 3, kBaseParameterCount>> rows;
  std::vector<Eigen::Vector3d> residuals;
  for (std::size_t k = 1; k + 1 < blocks.t.size(); ++k) {
    const Vector6d nu_dot = (blocks.nu[k + 1] - blocks.nu[k - 1]) / (blocks.t[k + 1] - blocks.t[k - 1]);
    const BaseRegressor Y = base_regressor(nu_dot, blocks.nu[k], blocks.R_WB[k]);
    Eigen::Matrix<double, 3, kBaseParameterCount> Y_scaled = Y.topRows<3>() * sigma.asDiagonal();
    Eigen::Vector3d residual = Y.topRows<3>() * mean - blocks.tau[k].head<3>();
    for (Eigen::Index axis = 0; axis < 3; ++axis) {
      if (vehicle.dof[static_cast<std::size_t>(axis)]) continue;
      Y_scaled.row(axis).setZero();
      residual[axis] = 0.0;
    }
    normal += Y_scaled.transpose() * Y_scaled;
    right -= Y_scaled.transpose() * residual;
    rows.push_back(Y_scaled);
    residuals.push_back(residual);
  }
  const BaseTheta step = solve_symmetric(normal, right);
  for (std::size_t k = 0; k < rows.size(); ++k) {
    residuals[k] = (blocks.R_WB[k + 1] * (residuals[k] + rows[k] * step)).eval();
  }
  return residuals;
}

/// The `most` local maxima of one share of the power that stand out most from their neighbourhood: differentiated noise
/// rises with frequency and must not outbid a line in a quiet place.
std::vector<Tone> peaks(const std::vector<Tone>& spectrum, std::size_t most, bool vertical) {
  std::vector<double> power, sum{0.0};
  for (const Tone& tone : spectrum) {
    power.push_back(vertical ? tone.cosine.z() * tone.cosine.z() + tone.sine.z() * tone.sine.z()
                             : tone.cosine.head<2>().squaredNorm() + tone.sine.head<2>().squaredNorm());
    sum.push_back(sum.back() + power.back());
  }
  struct Peak {
    double prominence;
    std::size_t at;
  };
  std::vector<Peak> found;
  for (std::size_t i = 1; i + 1 < spectrum.size(); ++i) {
    if (power[i] <= 0.0 || power[i] < power[i - 1] || power[i] <= power[i + 1]) continue;
    const std::size_t low = i > kNeighbours ? i - kNeighbours : 0;
    const std::size_t high = std::min(i + kNeighbours + 1, spectrum.size());
    found.push_back({power[i] * static_cast<double>(high - low) / (sum[high] - sum[low]), i});
  }
  std::stable_sort(found.begin(), found.end(),
                   [](const Peak& a, const Peak& b) { return a.prominence > b.prominence; });
  if (found.size() > most) found.resize(most);
  std::vector<Tone> strongest;
  strongest.reserve(found.size());
  for (const Peak& peak : found) strongest.push_back(spectrum[peak.at]);
  return strongest;
}

}  // namespace

Tones strongest_tones(const Vehicle& vehicle, const Trial& trial, std::size_t most) {
  if (!trial.observed.velocity || !trial.observed.attitude || trial.size() < 2) return {};
  const double span = trial.t.back() - trial.t.front();
  if (span < kShortestRun) return {};
  const Blocks blocks = block_means(trial, nominal_model(vehicle, trial.input_is_wrench).allocation);
  std::vector<Eigen::Vector3d> force = left_over(vehicle, blocks);
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& one : force) mean += one / static_cast<double>(force.size());

  // Half the resolution of the record apart, so that the strongest frequency is within a quarter of a line.
  std::vector<Tone> spectrum;
  spectrum.reserve(static_cast<std::size_t>((kHighest - kLowest) * span / std::numbers::pi) + 1);
  for (double omega = kLowest; omega < kHighest; omega += std::numbers::pi / span) {
    Tone tone{.omega = omega};
    for (std::size_t k = 0; k < force.size(); ++k) {
      const double phase = omega * blocks.t[k + 1];
      tone.cosine += std::cos(phase) * (force[k] - mean);
      tone.sine += std::sin(phase) * (force[k] - mean);
    }
    tone.cosine *= 2.0 / static_cast<double>(force.size());
    tone.sine *= 2.0 / static_cast<double>(force.size());
    spectrum.push_back(tone);
  }
  return {peaks(spectrum, most, false), peaks(spectrum, most, true)};
}

}  // namespace fathom::model
