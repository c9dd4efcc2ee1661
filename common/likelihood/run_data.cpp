#include "common/likelihood/run_data.hpp"

#include <algorithm>
#include <cmath>

#include "common/base/statistics.hpp"
#include "common/model/rollout.hpp"

namespace fathom::likelihood {
namespace {

constexpr double kMeanOverMad = 1.2533;  // standard deviation of a Gaussian number over its mean absolute value
constexpr double kLeastEcho = 0.4, kMostEcho = 0.9;
constexpr std::size_t kNeighbours = 50;  // samples on either side that tell how lively the motion is

void mark_measured(const Trial& trial, std::vector<std::array<std::uint8_t, 6>>& used) {
  for (std::size_t k = 0; k < trial.size(); ++k) {
    const bool velocity = trial.velocity_valid.empty() || trial.velocity_valid[k] != 0;
    const bool rates = trial.rates_valid.empty() || trial.rates_valid[k] != 0;
    for (std::size_t i = 0; i < 6; ++i) {
      used[k][i] = (i < 3 ? velocity : rates) && std::isfinite(trial.nu[k][static_cast<Eigen::Index>(i)]) ? 1 : 0;
    }
  }
}

/// A group whose three numbers are those of the sample before says nothing new.
std::size_t drop_held(const Trial& trial, std::vector<std::array<std::uint8_t, 6>>& used) {
  std::size_t held = 0;
  for (std::size_t k = trial.size(); k-- > 1;) {
    for (const Eigen::Index group : {0, 3}) {
      if ((trial.nu[k].segment<3>(group).array() != trial.nu[k - 1].segment<3>(group).array()).any()) continue;
      for (Eigen::Index i = group; i < group + 3; ++i) used[k][static_cast<std::size_t>(i)] = 0;
      ++held;
    }
  }
  return held;
}

std::size_t drop_spikes(const Trial& trial, std::vector<std::array<std::uint8_t, 6>>& used) {
  std::size_t spikes = 0;
  std::vector<double> series(trial.size());
  for (std::size_t i = 0; i < 6; ++i) {
    for (std::size_t k = 0; k < trial.size(); ++k) series[k] = trial.nu[k][static_cast<Eigen::Index>(i)];
    for (const std::size_t k : isolated_spikes(series)) {
      if (used[k][i] == 0) continue;
      used[k][i] = 0;
      ++spikes;
    }
  }
  return spikes;
}

}  // namespace

std::vector<std::size_t> isolated_spikes(const std::vector<double>& series, double limit) {
  const std::size_t n = series.size();
  std::vector<std::size_t> spikes;
  if (n < 2 * kNeighbours) return spikes;
  // Against the cubic through two neighbours on either side: smooth motion leaves nothing.
  std::vector<double> off(n, 0.0), sum(n + 1, 0.0);
  for (std::size_t k = 2; k + 2 < n; ++k)
    off[k] = series[k] - (4.0 * (series[k - 1] + series[k + 1]) - series[k - 2] - series[k + 2]) / 6.0;
  for (std::size_t k = 0; k < n; ++k) sum[k + 1] = sum[k] + std::abs(off[k]);
  const double everywhere = mad_sigma(off);
  for (std::size_t k = 2; k + 2 < n; ++k) {
    const double size = std::abs(off[k]);
    if (size < std::abs(off[k - 1]) || size < std::abs(off[k + 1]) || size == 0.0) continue;
    const std::size_t from = k > kNeighbours ? k - kNeighbours : 0, to = std::min(k + kNeighbours + 1, n);
    const double nearby = sum[to] - sum[from] - (sum[k + 3] - sum[k - 2]);
    const double here = kMeanOverMad * nearby / static_cast<double>(to - from - 5);
    // A spike leaves two thirds of itself, the other way, at both neighbours; a step or a burst does not.
    const double before = -off[k - 1] / off[k], after = -off[k + 1] / off[k];
    const bool alone = std::min(before, after) > kLeastEcho && std::max(before, after) < kMostEcho;
    if (alone && size > limit * std::max(everywhere, here)) spikes.push_back(k);
  }
  return spikes;
}

RunData::RunData(const Trial& trial, const model::Vehicle& vehicle, const RunSettings& settings) : trial_{&trial} {
  const std::size_t n = trial.size();
  used_.resize(n);
  mark_measured(trial, used_);
  held_ = drop_held(trial, used_);
  spikes_ = drop_spikes(trial, used_);
  for (auto& sample : used_) {
    for (std::size_t i = 0; i < 6; ++i) sample[i] = vehicle.dof[i] ? sample[i] : 0;  // the others are given
  }
  const double quickest = model::quickest_decay(vehicle);
  const double largest =
      std::clamp(settings.quickest_share * quickest, 0.1 * settings.largest_step, settings.largest_step);
  const auto parts = static_cast<int>(trial.parts());
  substeps_ = parts * std::max(1, static_cast<int>(std::ceil(trial.dt / parts / largest - 1e-9)));
  h_ = trial.dt / substeps_;
  block_size_ = static_cast<std::size_t>(std::max(1.0, std::round(1.0 / (settings.block_rate * trial.dt))));

  intervals_.resize(n > 0 ? n - 1 : 0);
  for (std::size_t k = 0; k + 1 < n; ++k) {
    Interval& at = intervals_[k];
    at.t = trial.t[k] + 0.5 * trial.dt;
    at.p_WB = 0.5 * (trial.p_WB[k] + trial.p_WB[k + 1]);
    const double way = trial.q_WB[k].dot(trial.q_WB[k + 1]) < 0.0 ? -1.0 : 1.0;
    Eigen::Quaterniond q;
    q.coeffs() = way * trial.q_WB[k].coeffs() + trial.q_WB[k + 1].coeffs();
    at.R_WB = q.normalized().toRotationMatrix();
    at.told = 0.5 * (trial.nu[k] + trial.nu[k + 1]);
    for (Eigen::Index i = 0; i < 6; ++i) {
      if (!vehicle.dof[static_cast<std::size_t>(i)])
        at.told_slope[i] = (trial.nu[k + 1][i] - trial.nu[k][i]) / trial.dt;
    }
    at.voltage = trial.voltage.empty() ? 0.0 : trial.voltage[k];
    if (!trial.columns.empty())
      at.columns = {trial.columns[k].data(), static_cast<std::size_t>(trial.columns[k].size())};
  }
  if (n == 0) return;
  start_ = trial.nu.front();
  const double burn_in =
      std::min(settings.burn_in, settings.burn_in_share * (trial.t.back() - trial.t.front())) + trial.t.front();
  for (std::size_t first = 0; first + block_size_ < n; first += block_size_) {
    Block block{.first = first, .last = first + block_size_};
    block.dt = static_cast<double>(block_size_) * trial.dt;
    block.scored = trial.t[block.last] > burn_in;
    const auto whole = static_cast<double>(block_size_);
    for (std::size_t axis = 0; axis < 6; ++axis) {
      const auto i = static_cast<Eigen::Index>(axis);
      double count = 0.0;
      for (std::size_t j = 1; j <= block_size_; ++j) {
        if (!used(first + j, axis)) continue;
        const double x = static_cast<double>(j) / whole;
        block.y[i] += trial.nu[first + j][i];
        count += 1.0;
        block.lag[i] += 1.0 - x;
        block.force_end[i] += x * x * (0.5 - x / 6.0);
        block.force_walk[i] += 0.5 * x * x;
        for (std::size_t m = 1; m <= block_size_; ++m) {
          if (!used(first + m, axis)) continue;
          const double low = static_cast<double>(std::min(j, m)) / whole,
                       high = static_cast<double>(std::max(j, m)) / whole;
          block.walk[i] += low;
          block.force_mean[i] += low * low * (0.5 * high - low / 6.0);
        }
      }
      block.n[i] = count;
      if (count == 0.0) continue;
      block.y[i] /= count;
      block.lag[i] /= count;
      block.force_end[i] /= count;
      block.force_walk[i] /= count;
      block.walk[i] /= count * count;
      block.force_mean[i] /= count * count;
    }
    blocks_.push_back(block);
  }
}

void RunData::leave_out(double from, double to) {
  for (Block& block : blocks_) {
    const double end = trial_->t[block.last];
    if (end >= from && end < to) block.scored = false;
  }
}

}  // namespace fathom::likelihood
