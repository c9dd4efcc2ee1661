#include "common/residual/prediction.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <random>

#include "common/base/distributions.hpp"

namespace fathom::residual {
namespace {

constexpr double kStride = 5.0;    // s
constexpr std::size_t kBlock = 6;  // windows per bootstrap block: 30 s, longer than the residual's memory
constexpr int kDraws = 1000;
constexpr unsigned kSeed = 20240607;
constexpr std::size_t kScoredHorizon = 1;

/// A prediction may start here: everything that is observed is valid.
bool can_start(const Trial& trial, std::size_t k) {
  return (!trial.observed.velocity || trial.velocity_valid[k] != 0) &&
         (!trial.observed.rates || trial.rates_valid[k] != 0) && (!trial.observed.attitude || trial.pose_valid[k] != 0);
}

std::size_t longest_prediction(const Trial& trial) {
  return std::max<std::size_t>(1, static_cast<std::size_t>(std::lround(kHorizons.back() / trial.dt)));
}

double normalised(const Predictions& predictions, std::span<const std::size_t> chosen, const model::Vehicle& vehicle) {
  double sum = 0.0, axes = 0.0;
  for (std::size_t axis = 0; axis < 6; ++axis) {
    if (!vehicle.dof[axis] || predictions.variance[kScoredHorizon][axis] <= 0.0) continue;
    double square = 0.0, count = 0.0;
    for (const std::size_t w : chosen) {
      square += predictions.windows[w].square[kScoredHorizon][axis];
      count += predictions.windows[w].count[kScoredHorizon][axis];
    }
    if (count > 0.0) {
      sum += std::sqrt(square / count / predictions.variance[kScoredHorizon][axis]);
      axes += 1.0;
    }
  }
  return axes > 0.0 ? sum / axes : 0.0;
}

/// Of the normalised error, from `before` to `after`, relative to before.
double fall(const Predictions& before, const Predictions& after, std::span<const std::size_t> chosen,
            const model::Vehicle& vehicle) {
  const double old_error = normalised(before, chosen, vehicle);
  return old_error > 0.0 ? 1.0 - normalised(after, chosen, vehicle) / old_error : 0.0;
}

std::vector<std::size_t> all_windows(const Predictions& predictions) {
  std::vector<std::size_t> all(predictions.windows.size());
  std::iota(all.begin(), all.end(), 0);
  return all;
}

}  // namespace

bool is_measured(const Trial& trial, std::size_t k, std::size_t axis) {
  return axis < 3 ? trial.observed.velocity && trial.velocity_valid[k] != 0
                  : trial.observed.rates && trial.rates_valid[k] != 0;
}

double lead_of(const model::Model& model) {
  double lead = 0.0;
  for (const model::ActiveEffect& active : model.effects) {
    const int actuators = static_cast<int>(model.allocation.cols());
    if (active.effect->state_size(*model.vehicle, actuators) > 0)
      lead = std::max(lead, active.effect->run_in(active.theta));
  }
  return lead;
}

std::vector<model::Window> prediction_windows(std::span<const Trial> trials, double lead) {
  std::vector<model::Window> windows;
  for (const Trial& trial : trials) {
    const std::size_t count = longest_prediction(trial) + 1;
    const auto stride = static_cast<std::size_t>(std::max(1L, std::lround(kStride / trial.dt)));
    auto first = static_cast<std::size_t>(std::ceil(lead / trial.dt - 1e-6));
    if (first + stride + count > trial.size()) first = 0;
    for (std::size_t start = first; start + count <= trial.size(); start += stride) {
      // The start may slip to the next sample at which everything observed is valid.
      std::size_t begin = start;
      while (begin < start + stride && begin + count <= trial.size() && !can_start(trial, begin)) ++begin;
      if (begin < start + stride && begin + count <= trial.size()) windows.push_back({&trial, begin, count});
    }
  }
  return windows;
}

Predictions predict(const model::Model& model, std::span<const model::Window> windows) {
  Predictions predictions;
  std::array<std::array<double, 6>, 3> sum{}, square{}, count{};
  model::VelocityTrace trace;
  for (const model::Window& window : windows) {
    const Trial& trial = *window.trial;
    model::rollout(model, window, model::true_velocity(model, trial, window.start), trace);
    WindowErrors errors;
    for (std::size_t k = 1; k < window.count; ++k) {
      const double elapsed = static_cast<double>(k) * trial.dt;
      for (std::size_t axis = 0; axis < 6; ++axis) {
        const auto a = static_cast<Eigen::Index>(axis);
        if (!is_measured(trial, window.start + k, axis)) continue;
        const double measured = trial.nu[window.start + k][a];
        const double error = trace(a, static_cast<Eigen::Index>(k)) - measured;
        for (std::size_t h = 0; h < kHorizons.size(); ++h) {
          if (elapsed > kHorizons[h] + 1e-9) continue;
          errors.square[h][axis] += error * error;
          errors.count[h][axis] += 1.0;
          sum[h][axis] += measured;
          square[h][axis] += measured * measured;
          count[h][axis] += 1.0;
        }
      }
    }
    predictions.windows.push_back(errors);
    for (std::size_t axis = 0; axis < 6; ++axis) {
      const double sigma = trial.nu_sigma[static_cast<Eigen::Index>(axis)];
      predictions.noise[axis] += sigma * sigma / static_cast<double>(windows.size());
    }
  }
  for (std::size_t h = 0; h < kHorizons.size(); ++h) {
    for (std::size_t axis = 0; axis < 6; ++axis) {
      if (count[h][axis] <= 1.0) continue;
      const double mean = sum[h][axis] / count[h][axis];
      predictions.variance[h][axis] = std::max(square[h][axis] / count[h][axis] - mean * mean, 0.0);
    }
  }
  return predictions;
}

std::vector<std::size_t> restarts(const Trial& trial) {
  std::vector<std::size_t> starts;
  for (std::size_t k = 0; k < trial.size();) {
    if (!can_start(trial, k)) {
      ++k;
      continue;
    }
    starts.push_back(k);
    k += longest_prediction(trial);
  }
  return starts;
}

std::vector<std::array<double, 6>> predict_anew(const model::Model& model, const Trial& trial,
                                                std::span<const std::size_t> starts) {
  constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
  std::vector<std::array<double, 6>> nu(trial.size(), {kNaN, kNaN, kNaN, kNaN, kNaN, kNaN});
  model::VelocityTrace trace;
  for (std::size_t s = 0; s < starts.size(); ++s) {
    const std::size_t end = s + 1 < starts.size() ? starts[s + 1] : trial.size();
    const std::size_t count = std::min(end - starts[s], longest_prediction(trial));
    model::rollout(model, {&trial, starts[s], count}, model::true_velocity(model, trial, starts[s]), trace);
    for (std::size_t k = 0; k < count; ++k) {
      for (std::size_t axis = 0; axis < 6; ++axis) {
        if (!model.vehicle->dof[axis]) continue;
        nu[starts[s] + k][axis] = trace(static_cast<Eigen::Index>(axis), static_cast<Eigen::Index>(k));
      }
    }
  }
  return nu;
}

std::vector<PredictionError> Predictions::summary(const model::Vehicle& vehicle) const {
  constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
  std::vector<PredictionError> rows;
  for (std::size_t h = 0; h < kHorizons.size(); ++h) {
    PredictionError row{.horizon_s = kHorizons[h]};
    for (std::size_t axis = 0; axis < 6; ++axis) {
      double total = 0.0, samples = 0.0;
      for (const WindowErrors& window : windows) {
        total += window.square[h][axis];
        samples += window.count[h][axis];
      }
      const bool known = vehicle.dof[axis] && samples > 0.0;
      row.rmse[axis] = known ? std::sqrt(total / samples) : kNaN;
      row.r2[axis] = known && variance[h][axis] > 0.0 ? 1.0 - total / samples / variance[h][axis] : kNaN;
      if (!known) continue;
      row.p_half[axis] = p_foretells(0.5, h, axis);
      row.p_average[axis] = p_foretells(0.0, h, axis);
    }
    rows.push_back(row);
  }
  return rows;
}

double Predictions::p_foretells(double share, std::size_t horizon, std::size_t axis) const {
  const double motion = std::max(variance[horizon][axis] - noise[axis], 0.0);
  const double allowed = (1.0 - share) * motion + 2.0 * noise[axis];
  double n = 0.0, sum = 0.0, square = 0.0;
  for (const WindowErrors& window : windows) {
    if (window.count[horizon][axis] <= 0.0) continue;
    const double beyond = window.square[horizon][axis] / window.count[horizon][axis] - allowed;
    n += 1.0;
    sum += beyond;
    square += beyond * beyond;
  }
  if (n < 2.0 || sum <= 0.0) return 1.0;
  const double scatter = (square - sum * sum / n) / (n - 1.0);  // of one window
  return scatter > 0.0 ? 0.5 * f_tail(sum * sum / n / scatter, n - 1.0) : 0.0;
}

Interval improvement(const Predictions& before, const Predictions& after, const model::Vehicle& vehicle) {
  Interval interval{.value = fall(before, after, all_windows(before), vehicle)};
  const std::size_t n = before.windows.size();
  if (n < 2 * kBlock) {
    interval.low = -std::numeric_limits<double>::infinity();
    interval.high = std::numeric_limits<double>::infinity();
    return interval;
  }
  std::mt19937 random{kSeed};
  std::uniform_int_distribution<std::size_t> start{0, n - kBlock};
  std::vector<double> draws;
  for (int draw = 0; draw < kDraws; ++draw) {
    std::vector<std::size_t> sample;
    while (sample.size() < n) {
      const std::size_t first = start(random);
      for (std::size_t i = 0; i < kBlock && sample.size() < n; ++i) sample.push_back(first + i);
    }
    draws.push_back(fall(before, after, sample, vehicle));
  }
  std::sort(draws.begin(), draws.end());
  interval.low = draws[static_cast<std::size_t>(0.025 * kDraws)];
  interval.high = draws[static_cast<std::size_t>(0.975 * kDraws)];
  return interval;
}

}  // namespace fathom::residual
