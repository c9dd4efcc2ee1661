#include "common/identification/pose_fit.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>

#include "common/base/parallel.hpp"
#include "common/identification/pose_window.hpp"
#include "common/identification/reduced_window.hpp"
#include "common/identification/signal_weights.hpp"
#include "common/identification/two_estimates.hpp"

namespace fathom::identification {
namespace {

constexpr int kWeightRounds = 2;
constexpr int kSteps = 9;              // of Gauss and Newton, per round of weights
constexpr int kStepsOfOne = 6;         // with the same derivatives: the fit by velocities is close
constexpr double kMostKept = 2e7;      // derivatives: 160 MB. Of longer recordings they are made anew at each step
constexpr int kHalvings = 4;           // of a step that does not lower the cost
constexpr double kSettled = 0.01;      // of the cost, which is a chi-square: far below one standard deviation
constexpr double kCredible = 100.0;    // times as exact as by velocities
constexpr double kLeastFreedom = 3.0;  // of a covariance from fewer stretches than it has numbers

class PoseFit {
 public:
  PoseFit(const model::Vehicle& vehicle, std::span<const Trial> trials, const PoseFitSettings& settings,
          const model::Model& model)
      : settings_{settings},
        model_{model},
        map_{model},
        windows_{pose_windows(vehicle, trials, settings.window)},
        x_{map_.pack(model)} {
    double entries = 0.0;
    for (const PoseWindow& window : windows_) {
      starts_.push_back(window.measured_start());
      entries += static_cast<double>(window.rows()) * static_cast<double>(map_.size() + window.free().size());
    }
    keeps_ = entries < kMostKept;
    weights_ = ordinary_weights();
  }

  [[nodiscard]] bool any() const { return !windows_.empty(); }

  /// False when it does not come to rest.
  bool solve() {
    renew();
    const std::vector<Eigen::Index> none;
    if (!descend(none)) return false;
    for (int round = 0; round < kWeightRounds; ++round) {
      weights_ = signal_weights(windows_, residuals(x_, starts_), settings_.block);
      if (!descend(inside())) return false;
    }
    return true;
  }

  [[nodiscard]] model::Model model() const { return model_at(x_); }

  /// Sandwich over stretches, physical units; at least what the weights alone say, for few stretches can look too
  /// quiet. `freedom`: stretches beyond free numbers.
  [[nodiscard]] Eigen::MatrixXd covariance(double& freedom) {
    const auto n = static_cast<Eigen::Index>(map_.size());
    Eigen::MatrixXd information = prior(), meat = information;
    double clusters = 0.0;
    renew();
    for (const ReducedWindow& window : linearise(sought())) {
      information += window.H;
      meat += window.scores * window.scores.transpose();
      clusters += static_cast<double>(window.scores.cols());
    }
    const auto free = static_cast<double>(inside().size());
    const double small_sample = clusters > free + 1.0 ? clusters / (clusters - free) : 2.0;
    const Eigen::MatrixXd inverse = information.ldlt().solve(Eigen::MatrixXd::Identity(n, n));
    Eigen::VectorXd scale(n);
    for (Eigen::Index i = 0; i < n; ++i) scale[i] = map_[static_cast<std::size_t>(i)].scale;
    freedom = std::max(clusters - free, kLeastFreedom);
    Eigen::MatrixXd covariance = small_sample * inverse * meat * inverse;
    const Eigen::VectorXd wider = (inverse.diagonal().cwiseQuotient(covariance.diagonal())).cwiseMax(1.0).cwiseSqrt();
    scale.array() *= wider.array();
    return scale.asDiagonal() * covariance * scale.asDiagonal();
  }

 private:
  [[nodiscard]] model::Model model_at(const Eigen::VectorXd& x) const {
    model::Model model = model_;
    map_.unpack(x, model);
    return model;
  }

  /// Numbers that move: sought, and not on a bound.
  [[nodiscard]] std::vector<Eigen::Index> inside() const {
    std::vector<Eigen::Index> free;
    for (std::size_t i = 0; i < map_.size(); ++i) {
      const auto k = static_cast<Eigen::Index>(i);
      if (map_[i].sought && !map_[i].at_bound(x_[k])) free.push_back(k);
    }
    return free;
  }

  [[nodiscard]] std::vector<Eigen::Index> sought() const {
    std::vector<Eigen::Index> all;
    for (std::size_t i = 0; i < map_.size(); ++i) {
      if (map_[i].sought) all.push_back(static_cast<Eigen::Index>(i));
    }
    return all;
  }

  [[nodiscard]] Eigen::MatrixXd prior() const {
    const auto n = static_cast<Eigen::Index>(map_.size());
    Eigen::MatrixXd information = Eigen::MatrixXd::Zero(n, n);
    for (Eigen::Index i = 0; i < n; ++i) {
      const FreeParameter& free = map_[static_cast<std::size_t>(i)];
      information(i, i) = (free.scale / free.prior_sigma) * (free.scale / free.prior_sigma);
    }
    return information;
  }

  [[nodiscard]] Eigen::VectorXd prior_gradient(const Eigen::VectorXd& x) const {
    Eigen::VectorXd gradient(x.size());
    for (Eigen::Index i = 0; i < x.size(); ++i) {
      const FreeParameter& free = map_[static_cast<std::size_t>(i)];
      gradient[i] = free.scale / free.prior_sigma * (x[i] * free.scale - free.prior_mean) / free.prior_sigma;
    }
    return gradient;
  }

  [[nodiscard]] std::vector<Eigen::VectorXd> residuals(const Eigen::VectorXd& x,
                                                       const std::vector<WindowStart>& starts) const {
    const model::Model model = model_at(x);
    std::vector<Eigen::VectorXd> all(windows_.size());
    for_each_index(windows_.size(), settings_.threads, [&](std::size_t w) {
      all[w].resize(windows_[w].rows());
      windows_[w].evaluate(model, starts[w], all[w]);
    });
    return all;
  }

  [[nodiscard]] double cost(const Eigen::VectorXd& x, const std::vector<WindowStart>& starts) const {
    double sum = 0.0;
    for (Eigen::Index i = 0; i < x.size(); ++i) {
      const FreeParameter& free = map_[static_cast<std::size_t>(i)];
      const double away = (x[i] * free.scale - free.prior_mean) / free.prior_sigma;
      sum += 0.5 * away * away;
    }
    const std::vector<Eigen::VectorXd> all = residuals(x, starts);
    for (std::size_t w = 0; w < windows_.size(); ++w) {
      if (!all[w].allFinite()) return std::numeric_limits<double>::infinity();
      sum += 0.5 * weights_[w].cwiseProduct(all[w]).squaredNorm();
      sum += 0.5 * (starts[w] - windows_[w].measured_start()).squaredNorm() / (kFreeStart * kFreeStart);
    }
    return sum;
  }

  /// Derivatives here, of all that is sought.
  void renew() {
    steps_of_one_ = 0;
    if (!keeps_) return;
    const model::Model model = model_at(x_);
    const std::vector<Eigen::Index> all = sought();
    jacobians_.resize(windows_.size());
    for_each_index(windows_.size(), settings_.threads, [&](std::size_t w) {
      Eigen::VectorXd residual(windows_[w].rows());
      windows_[w].evaluate(model, starts_[w], residual);
      jacobians_[w] = windows_[w].jacobian(model, map_, all, starts_[w], residual);
    });
  }

  [[nodiscard]] Eigen::MatrixXd jacobian(const model::Model& model, const std::vector<Eigen::Index>& moving,
                                         std::size_t w, const Eigen::VectorXd& residual) const {
    if (!keeps_) return windows_[w].jacobian(model, map_, moving, starts_[w], residual);
    Eigen::MatrixXd J = jacobians_[w];
    for (Eigen::Index i = 0; i < static_cast<Eigen::Index>(map_.size()); ++i) {
      if (std::ranges::find(moving, i) == moving.end()) J.col(i).setZero();
    }
    return J;
  }

  [[nodiscard]] std::vector<ReducedWindow> linearise(const std::vector<Eigen::Index>& moving) const {
    const model::Model model = model_at(x_);
    std::vector<ReducedWindow> all(windows_.size());
    for_each_index(windows_.size(), settings_.threads, [&](std::size_t w) { all[w] = reduce(model, moving, w); });
    return all;
  }

  [[nodiscard]] ReducedWindow reduce(const model::Model& model, const std::vector<Eigen::Index>& moving,
                                     std::size_t w) const {
    const PoseWindow& window = windows_[w];
    Eigen::VectorXd residual(window.rows());
    window.evaluate(model, starts_[w], residual);
    Eigen::MatrixXd J = jacobian(model, moving, w, residual);
    return reduced(window, starts_[w], weights_[w], std::move(J), std::move(residual), settings_.block);
  }

  /// Moves `free` and all beginnings to where the cost is least.
  bool descend(const std::vector<Eigen::Index>& free) {
    double now = cost(x_, starts_);
    for (int step = 0; step < kSteps && std::isfinite(now); ++step) {
      if (steps_of_one_ >= kStepsOfOne) renew();
      const std::vector<ReducedWindow> windows = linearise(free);
      Eigen::MatrixXd H = prior();
      Eigen::VectorXd g = prior_gradient(x_);
      double gain = 0.0, gain_of_starts = 0.0;
      for (const ReducedWindow& window : windows) {
        H += window.H;
        g += window.g;
        gain_of_starts += window.own_gain;
      }
      Eigen::VectorXd move = Eigen::VectorXd::Zero(x_.size());
      if (!free.empty()) {
        move(free) = -H(free, free).ldlt().solve(g(free));
        gain = -0.5 * g.dot(move);
      }
      double share = 1.0, next = std::numeric_limits<double>::infinity();
      Eigen::VectorXd x;
      std::vector<WindowStart> starts;
      for (int halving = 0; halving <= kHalvings; ++halving, share *= 0.5) {
        x = within_bounds(x_ + share * move);
        starts = starts_;
        for (std::size_t w = 0; w < windows.size(); ++w) {
          const Eigen::VectorXd follow = share * windows[w].own_step + windows[w].follow * (x - x_);
          for (std::size_t s = 0; s < windows_[w].free().size(); ++s)
            starts[w][windows_[w].free()[s]] += follow[static_cast<Eigen::Index>(s)];
        }
        next = cost(x, starts);
        if (next < now) break;
      }
      const bool fresh = steps_of_one_ == 0 || !keeps_;
      const double settled = kSettled * static_cast<double>(windows.size());
      if (!(next < now)) {
        if (fresh || (gain < kSettled && gain_of_starts < settled)) return gain < kSettled || now - next > -kSettled;
        renew();
        continue;
      }
      steps_of_one_ = share < 1.0 ? kStepsOfOne : steps_of_one_ + 1;  // far from what they foretell: they are old
      const double fell = now - next;
      x_ = std::move(x);
      starts_ = std::move(starts);
      now = next;
      if (gain < kSettled && fell < settled) return true;
    }
    return false;
  }

  [[nodiscard]] Eigen::VectorXd within_bounds(Eigen::VectorXd x) const {
    for (std::size_t i = 0; i < map_.size(); ++i) {
      const auto k = static_cast<Eigen::Index>(i);
      x[k] = std::clamp(x[k], map_[i].low / map_[i].scale, map_[i].high / map_[i].scale);
    }
    return x;
  }

  [[nodiscard]] std::vector<Eigen::VectorXd> ordinary_weights() const {
    std::vector<Eigen::VectorXd> weights;
    for (const PoseWindow& window : windows_) {
      Eigen::VectorXd weight(window.rows());
      for (Eigen::Index i = 0; i < window.rows(); ++i) weight[i] = 1.0 / ordinary_noise(window.row(i).signal);
      weights.push_back(std::move(weight));
    }
    return weights;
  }

  PoseFitSettings settings_;
  const model::Model& model_;
  ParameterMap map_;
  std::vector<PoseWindow> windows_;
  std::vector<WindowStart> starts_;
  std::vector<Eigen::VectorXd> weights_;
  std::vector<Eigen::MatrixXd> jacobians_;  // per window, not weighted, of all that is sought; when they are kept
  bool keeps_{};
  int steps_of_one_{};
  Eigen::VectorXd x_;
};

/// Places tell a number four times as well as velocities do, ten times on craft that tilt. Hundreds of times mean a
/// trajectory that runs away from any other: all of them tell, so sharply that nothing real agrees.
bool credible(const Eigen::MatrixXd& by_speeds, const Eigen::MatrixXd& by_poses) {
  return by_speeds.rows() != by_poses.rows() ||
         (by_speeds.diagonal().array() < kCredible * kCredible * by_poses.diagonal().array() ||
          by_speeds.diagonal().array() <= 0.0)
             .all();
}

}  // namespace

std::optional<FitResult> fit_with_poses(const model::Vehicle& vehicle, std::span<const Trial> trials,
                                        const PoseFitSettings& settings, const FitResult& by_speeds) {
  PoseFit problem{vehicle, trials, settings, by_speeds.model};
  if (!problem.any() || !problem.solve()) return {};
  FitResult fit = by_speeds;
  fit.model = problem.model();
  if (!agree(by_speeds, fit.model)) return {};
  fit.covariance = problem.covariance(fit.freedom);
  if (!fit.covariance.allFinite() || !credible(by_speeds.covariance, fit.covariance)) return {};
  fit.interval95 = drawn_in(by_speeds, fit);
  return fit;
}

}  // namespace fathom::identification
