#include "common/verdict/skill.hpp"

#include <algorithm>
#include <cmath>

#include "common/base/distributions.hpp"
#include "common/base/factors.hpp"

namespace fathom::verdict {
namespace {

using residual::kHorizons;
using residual::Predictions;
using residual::WindowErrors;

constexpr double kSpan = 0.25;       // s over which an acceleration is taken: sensor noise is then small beside it
constexpr double kMostStep = 1.5;    // times that, or what lies between two measurements: farther apart is a gap
constexpr double kMostSpeed = 50.0;  // m/s, rad/s: what a plain equation makes beyond is nonsense, and its error enough

Vector6d wrench(const model::Allocation& allocation, const Trial& trial, std::size_t k) {
  return allocation * (0.5 * (trial.input[k] + trial.input[std::min(k + 1, trial.size() - 1)]));
}

/// The world's down, in the body; as if level where no attitude was measured.
Eigen::Vector3d down_of(const Trial& trial, std::size_t k) {
  if (!trial.observed.attitude) return Eigen::Vector3d::UnitZ();
  return trial.q_WB[k].conjugate() * Eigen::Vector3d::UnitZ();
}

/// What weight and buoyancy turn the axis by when the craft is tilted goes with this part of it; 0 of other axes.
double tilt_of(const Eigen::Vector3d& down_B, std::size_t axis) {
  return axis == 3 ? -down_B.y() : axis == 4 ? down_B.x() : 0.0;
}

/// Samples to the next measurement of an axis, as a rule, and at least those of kSpan.
std::size_t span_of(const Trial& trial, std::size_t axis) {
  std::vector<std::size_t> steps;
  for (std::size_t k = 0, before = trial.size(); k < trial.size(); ++k) {
    if (!residual::is_measured(trial, k, axis)) continue;
    if (before < k) steps.push_back(k - before);
    before = k;
  }
  const auto least = std::max<std::size_t>(1, static_cast<std::size_t>(std::lround(kSpan / trial.dt)));
  if (steps.empty()) return least;
  const auto middle = steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2);
  std::ranges::nth_element(steps, middle);
  return std::max(least, *middle);
}

/// Errors of velocities that `step` carries on: nu of sample k becomes that of k + 1.
template <typename Step>
Predictions predict_by(std::span<const model::Window> windows, const Step& step) {
  Predictions predictions;
  for (const model::Window& window : windows) {
    const Trial& trial = *window.trial;
    Vector6d nu = trial.nu[window.start];
    WindowErrors errors;
    for (std::size_t k = 1; k < window.count; ++k) {
      step(trial, window.start + k - 1, nu);
      for (std::size_t axis = 0; axis < 6; ++axis) {
        if (!residual::is_measured(trial, window.start + k, axis)) continue;
        const auto a = static_cast<Eigen::Index>(axis);
        const double error = nu[a] - trial.nu[window.start + k][a];
        for (std::size_t h = 0; h < kHorizons.size(); ++h) {
          if (static_cast<double>(k) * trial.dt > kHorizons[h] + 1e-9) continue;
          errors.square[h][axis] += error * error;
          errors.count[h][axis] += 1.0;
        }
      }
    }
    predictions.windows.push_back(errors);
  }
  return predictions;
}

}  // namespace

double mean_square(const Predictions& predictions, std::size_t h, std::size_t axis) {
  double square = 0.0, count = 0.0;
  for (const WindowErrors& window : predictions.windows) {
    square += window.square[h][axis];
    count += window.count[h][axis];
  }
  return count > 0.0 ? square / count : -1.0;
}

std::array<PlainAxis, 6> plain_fit(const model::Vehicle& vehicle, std::span<const Trial> trials) {
  using Information = Eigen::Matrix<double, 5, 5>;
  using Row = Eigen::Vector<double, 5>;
  std::array<PlainAxis, 6> plain{};
  for (std::size_t axis = 0; axis < 6; ++axis) {
    if (!vehicle.dof[axis]) continue;
    const auto a = static_cast<Eigen::Index>(axis);
    Information A = Information::Zero();
    Row b = Row::Zero();
    double square = 0.0, count = 0.0;
    for (const Trial& trial : trials) {
      const model::Allocation allocation = model::nominal_model(vehicle, trial.input_is_wrench).allocation;
      const std::size_t span = span_of(trial, axis);
      const auto most = static_cast<std::size_t>(kMostStep * static_cast<double>(span));
      for (std::size_t k = 0, next = 0; k + span < trial.size(); k = next) {
        next = k + 1;
        if (!residual::is_measured(trial, k, axis)) continue;
        next = k + span;
        while (next < trial.size() && next <= k + most && !residual::is_measured(trial, next, axis)) ++next;
        if (next >= trial.size() || next > k + most) continue;
        Row row = Row::Zero();
        for (std::size_t j = k; j < next; ++j) {
          const double nu = 0.5 * (trial.nu[j][a] + trial.nu[j + 1][a]);
          const double tilt = 0.5 * (tilt_of(down_of(trial, j), axis) + tilt_of(down_of(trial, j + 1), axis));
          row += Row{{wrench(allocation, trial, j)[a], nu, std::abs(nu) * nu, 1.0, tilt}};
        }
        const auto steps = static_cast<double>(next - k);
        row /= steps;
        const double acceleration = (trial.nu[next][a] - trial.nu[k][a]) / (steps * trial.dt);
        if (!row.allFinite() || !std::isfinite(acceleration)) continue;
        A += row * row.transpose();
        b += acceleration * row;
        square += acceleration * acceleration;
        count += 1.0;
      }
    }
    if (count < 20.0) continue;
    const Row scale = A.diagonal().cwiseSqrt().unaryExpr([](double x) { return x > 0.0 ? 1.0 / x : 0.0; });
    // Scaled, and with a trace of a ridge: an input that is always zero leaves the others their meaning.
    const Information scaled =
        scale.asDiagonal() * A * scale.asDiagonal() + 1e-9 * Information{Information::Identity()};
    const Row right = scale.cwiseProduct(b);
    const SymmetricFactor of_axis{Eigen::MatrixXd{scaled.topLeftCorner<4, 4>()}}, with_tilt{scaled};
    const Eigen::Vector4d x = scale.head<4>().cwiseProduct(Eigen::Vector4d{of_axis.solve(right.head<4>())});
    const Row y = scale.cwiseProduct(Row{with_tilt.solve(right)});
    const double residual = std::max(square - b.dot(y), 1e-12 * square) / (count - 5.0);
    const double variance = residual * scale[0] * scale[0] * with_tilt.solve(Row::Unit(0))[0];
    plain[axis] = {x[0], x[1], x[2], x[3], variance > 0.0 ? y[0] / std::sqrt(variance) : 0.0, true};
  }
  return plain;
}

Predictions predict_unchanged(std::span<const model::Window> windows) {
  return predict_by(windows, [](const Trial&, std::size_t, Vector6d&) {});
}

Predictions predict_plainly(const model::Vehicle& vehicle, const std::array<PlainAxis, 6>& plain,
                            std::span<const model::Window> windows) {
  const model::Allocation of_wrench = model::nominal_model(vehicle, true).allocation,
                          of_thrusters = model::nominal_model(vehicle, false).allocation;
  return predict_by(windows, [&](const Trial& trial, std::size_t k, Vector6d& nu) {
    const Vector6d tau = wrench(trial.input_is_wrench ? of_wrench : of_thrusters, trial, k);
    for (std::size_t axis = 0; axis < 6; ++axis) {
      const auto a = static_cast<Eigen::Index>(axis);
      const PlainAxis& p = plain[axis];
      if (!p.known) continue;
      const auto rate = [&](double v) {
        return p.input * tau[a] + p.linear * v + p.quadratic * std::abs(v) * v + p.constant;
      };
      const double middle = nu[a] + 0.5 * trial.dt * rate(nu[a]);
      nu[a] = std::clamp(nu[a] + trial.dt * rate(middle), -kMostSpeed, kMostSpeed);
    }
  });
}

std::vector<SkillGiven> skill_of(const model::Vehicle& vehicle, const Predictions& model, const Predictions& unchanged,
                                 const Predictions& plain) {
  std::vector<SkillGiven> rows;
  for (std::size_t h = 0; h < kHorizons.size(); ++h) {
    for (std::size_t axis = 0; axis < 6; ++axis) {
      const double own = mean_square(model, h, axis), still = mean_square(unchanged, h, axis),
                   by_axis = mean_square(plain, h, axis);
      if (!vehicle.dof[axis] || !(own >= 0.0) || !(still > 0.0) || !(by_axis > 0.0)) continue;
      rows.push_back({.horizon_s = kHorizons[h],
                      .axis = model::kAxisNames[axis],
                      .rmse = std::sqrt(own),
                      .rmse_unchanged = std::sqrt(still),
                      .rmse_plain = std::sqrt(by_axis),
                      .over_unchanged = 1.0 - own / still,
                      .over_plain = 1.0 - own / by_axis});
    }
  }
  return rows;
}

double p_no_worse(const Predictions& model, const Predictions& simpler, std::size_t horizon, std::size_t axis) {
  double n = 0.0, sum = 0.0, square = 0.0;
  for (std::size_t w = 0; w < model.windows.size(); ++w) {
    const double count = model.windows[w].count[horizon][axis];
    if (count <= 0.0) continue;
    const double beyond = (model.windows[w].square[horizon][axis] - simpler.windows[w].square[horizon][axis]) / count;
    n += 1.0;
    sum += beyond;
    square += beyond * beyond;
  }
  if (n < 3.0 || sum <= 0.0) return 1.0;
  const double scatter = (square - sum * sum / n) / (n - 1.0);  // of one window
  return scatter > 0.0 ? 0.5 * f_tail(sum * sum / n / scatter, n - 1.0) : 0.0;
}

}  // namespace fathom::verdict
