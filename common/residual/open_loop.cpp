#include "common/residual/open_loop.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "common/base/statistics.hpp"

namespace fathom::residual {
namespace {

bool measured(const Trial& trial, std::size_t k, std::size_t axis) {
  return axis < 3 ? trial.observed.velocity && trial.velocity_valid[k] != 0
                  : trial.observed.rates && trial.rates_valid[k] != 0;
}

/// rms of every simulated axis' velocity; 0 where it is not simulated or never moved.
Vector6d sizes_of(const Trial& trial, const model::Vehicle& vehicle) {
  Vector6d square = Vector6d::Zero(), count = Vector6d::Zero();
  for (std::size_t k = 0; k < trial.size(); ++k) {
    for (std::size_t axis = 0; axis < 6; ++axis) {
      if (!vehicle.dof[axis] || !measured(trial, k, axis)) continue;
      const auto i = static_cast<Eigen::Index>(axis);
      square[i] += trial.nu[k][i] * trial.nu[k][i];
      count[i] += 1.0;
    }
  }
  return (square.array() / count.array().max(1.0)).sqrt().matrix();
}

double scaled_square(const Vector6d& x, const Vector6d& sizes) {
  double sum = 0.0;
  for (Eigen::Index i = 0; i < 6; ++i) sum += sizes[i] > 0.0 ? x[i] * x[i] / (sizes[i] * sizes[i]) : 0.0;
  return sum;
}

/// Changes of a start: sway and heave with what turns them, and against it, since what one does to a craft that turns
/// by itself the other may undo.
constexpr std::array kChanges{std::array{1.0, 1.0, 1.0, 1.0, 1.0, 1.0}, std::array{1.0, -1.0, -1.0, 1.0, 1.0, 1.0}};

/// Samples over which a small change of the start stays small.
std::size_t foreseeable(const model::Model& model, const model::Window& window, const Vector6d& nu0,
                        const model::VelocityTrace& trace, const Vector6d& sizes, const OpenLoop& how) {
  model::VelocityTrace moved;
  auto samples = static_cast<std::size_t>(trace.cols());
  for (const auto& way : kChanges) {
    const Vector6d change = how.start_change * sizes.cwiseProduct(Eigen::Map<const Vector6d>{way.data()});
    model::rollout(model, window, nu0 + change, moved);
    const double limit = how.growth * how.growth * scaled_square(change, sizes);
    for (std::size_t k = 0; k < samples; ++k) {
      const auto at = static_cast<Eigen::Index>(k);
      if (!(scaled_square(moved.col(at) - trace.col(at), sizes) <= limit)) samples = k;
    }
  }
  return samples;
}

double error_of(const model::VelocityTrace& trace, const model::Window& window, std::size_t samples,
                const Vector6d& sizes) {
  double square = 0.0;
  for (std::size_t k = 1; k < samples; ++k) {
    Vector6d off = trace.col(static_cast<Eigen::Index>(k)) - window.trial->nu[window.start + k];
    for (std::size_t axis = 0; axis < 6; ++axis) {
      if (!measured(*window.trial, window.start + k, axis)) off[static_cast<Eigen::Index>(axis)] = 0.0;
    }
    square += scaled_square(off, sizes);
  }
  return std::sqrt(square / static_cast<double>(std::max<std::size_t>(samples, 2) - 1));
}

}  // namespace

void compare(const model::Model& base, const model::Model& other, std::span<const model::Window> windows,
             const OpenLoop& how, Compared& compared) {
  const Trial* of = nullptr;
  Vector6d sizes = Vector6d::Zero();
  model::VelocityTrace by_base, by_other;
  for (const model::Window& window : windows) {
    const Trial& trial = *window.trial;
    if (of != &trial) sizes = sizes_of(trial, *base.vehicle);
    of = &trial;
    const Vector6d base_start = model::true_velocity(base, trial, window.start),
                   other_start = model::true_velocity(other, trial, window.start);
    model::rollout(base, window, base_start, by_base);
    const bool finished = model::rollout(other, window, other_start, by_other);
    std::size_t samples = foreseeable(base, window, base_start, by_base, sizes, how);
    if (finished) samples = std::min(samples, foreseeable(other, window, other_start, by_other, sizes, how));
    if (static_cast<double>(samples) * trial.dt < how.shortest) continue;
    if (samples < window.count) ++compared.shortened;
    const double one = error_of(by_base, window, samples, sizes), two = error_of(by_other, window, samples, sizes);
    if (!(one > 0.0) || !std::isfinite(one)) continue;
    compared.log_ratio.push_back(std::isfinite(two) && two > 0.0 ? std::log(two / one) : 10.0);
  }
}

Foreseen foreseen(std::span<const model::Window> windows, std::span<const model::Model* const> models,
                  const OpenLoop& how) {
  Foreseen all;
  std::vector<double> lengths;
  const Trial* of = nullptr;
  Vector6d sizes = Vector6d::Zero();
  model::VelocityTrace trace;
  for (model::Window window : windows) {
    const Trial& trial = *window.trial;
    if (of != &trial && !models.empty()) sizes = sizes_of(trial, *models.front()->vehicle);
    of = &trial;
    std::size_t samples = window.count;
    for (const model::Model* one : models) {
      const Vector6d start = model::true_velocity(*one, trial, window.start);
      if (model::rollout(*one, window, start, trace))
        samples = std::min(samples, foreseeable(*one, window, start, trace, sizes, how));
    }
    const auto least = static_cast<std::size_t>(std::lround(how.shortest / trial.dt)) + 1;
    samples = std::min(std::max(samples, least), window.count);
    if (samples < window.count) lengths.push_back(static_cast<double>(samples - 1) * trial.dt);
    window.count = samples;
    all.windows.push_back(window);
  }
  all.cut = static_cast<int>(lengths.size());
  if (!lengths.empty()) all.typical = median(std::move(lengths));
  return all;
}

std::vector<model::Window> windows_within(const Trial& trial, double from, double to, const OpenLoop& how) {
  std::vector<model::Window> windows;
  const auto count = static_cast<std::size_t>(std::lround(how.horizon / trial.dt)) + 1;
  const auto all = [&](std::size_t k) {
    return (!trial.observed.velocity || trial.velocity_valid[k] != 0) &&
           (!trial.observed.rates || trial.rates_valid[k] != 0);
  };
  std::size_t k = static_cast<std::size_t>(std::ranges::lower_bound(trial.t, from) - trial.t.begin());
  for (; k < trial.size() && trial.t[k] < to; ++k) {
    if (!all(k)) continue;
    const auto left = static_cast<std::size_t>(std::ranges::lower_bound(trial.t, to) - trial.t.begin()) - k;
    const std::size_t here = std::min(count, left);
    if (static_cast<double>(here) * trial.dt < 0.5 * how.horizon) break;
    windows.push_back({&trial, k, here});
    k += here - 1;
  }
  return windows;
}

Ratio ratio_of(const Compared& compared) {
  const auto n = static_cast<double>(compared.log_ratio.size());
  Ratio ratio{.windows = static_cast<int>(compared.log_ratio.size())};
  if (n < 2.0) return ratio;
  double mean = 0.0, square = 0.0;
  for (const double x : compared.log_ratio) mean += x / n;
  for (const double x : compared.log_ratio) square += (x - mean) * (x - mean);
  ratio.value = std::exp(mean);
  ratio.log_error = std::sqrt(square / (n - 1.0) / n);
  return ratio;
}

Ratio error_over(const model::Model& base, const model::Model& other, std::span<const Trial> trials,
                 const OpenLoop& how) {
  Compared compared;
  for (const Trial& trial : trials)
    compare(base, other, windows_within(trial, trial.t.front(), trial.t.back(), how), how, compared);
  return ratio_of(compared);
}

}  // namespace fathom::residual
