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
constexpr double kMostSpeed = 50.0;  // m/s, rad/s: what a plain equation makes beyond is nonsense, and its error enough

Vector6d wrench(const model::Allocation& allocation, const Trial& trial, std::size_t k) {
  return allocation * (0.5 * (trial.input[k] + trial.input[std::min(k + 1, trial.size() - 1)]));
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
  using Information = Eigen::Matrix4d;
  std::array<PlainAxis, 6> plain{};
  for (std::size_t axis = 0; axis < 6; ++axis) {
    if (!vehicle.dof[axis]) continue;
    const auto a = static_cast<Eigen::Index>(axis);
    Information A = Information::Zero();
    Eigen::Vector4d b = Eigen::Vector4d::Zero();
    double square = 0.0, count = 0.0;
    for (const Trial& trial : trials) {
      const model::Allocation allocation = model::nominal_model(vehicle, trial.input_is_wrench).allocation;
      const auto span = std::max<std::size_t>(1, static_cast<std::size_t>(std::lround(kSpan / trial.dt)));
      for (std::size_t k = 0; k + span < trial.size(); k += span) {
        if (!residual::is_measured(trial, k, axis) || !residual::is_measured(trial, k + span, axis)) continue;
        Eigen::Vector4d row = Eigen::Vector4d::Zero();
        for (std::size_t j = k; j < k + span; ++j) {
          const double nu = 0.5 * (trial.nu[j][a] + trial.nu[j + 1][a]);
          row += Eigen::Vector4d{wrench(allocation, trial, j)[a], nu, std::abs(nu) * nu, 1.0};
        }
        row /= static_cast<double>(span);
        const double acceleration = (trial.nu[k + span][a] - trial.nu[k][a]) / (static_cast<double>(span) * trial.dt);
        if (!row.allFinite() || !std::isfinite(acceleration)) continue;
        A += row * row.transpose();
        b += acceleration * row;
        square += acceleration * acceleration;
        count += 1.0;
      }
    }
    if (count < 20.0) continue;
    // Scaled, and with a trace of a ridge: an input that is always zero leaves the others their meaning.
    const Eigen::Vector4d scale = A.diagonal().cwiseSqrt().unaryExpr([](double x) { return x > 0.0 ? 1.0 / x : 0.0; });
    const Information scaled =
        scale.asDiagonal() * A * scale.asDiagonal() + 1e-9 * Information{Information::Identity()};
    const SymmetricFactor factor{scaled};
    const Eigen::Vector4d x = scale.cwiseProduct(factor.solve(scale.cwiseProduct(b)));
    const double residual = std::max(square - b.dot(x), 1e-12 * square) / (count - 4.0);
    const double variance = residual * scale[0] * scale[0] * factor.solve(Eigen::Vector4d::Unit(0))[0];
    plain[axis] = {x[0], x[1], x[2], x[3], variance > 0.0 ? x[0] / std::sqrt(variance) : 0.0, true};
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
