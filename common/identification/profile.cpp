#include "common/identification/profile.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "common/identification/parameter_map.hpp"

namespace fathom::identification {
namespace {

constexpr int kSteps = 4;           // of the other numbers, at one place
constexpr double kSettled = 0.1;    // of the rise: what a further step of the others may still bring
constexpr int kProbes = 6;          // of one side
constexpr double kNear = 0.25;      // of the rise: near enough for a parabola
constexpr double kFarthest = 15.0;  // of half an interval
constexpr double kLongestStride = 3.0;

/// Cost over one number, all others following: beyond their physical bounds too, as they may in the covariance. A
/// number that was stopped by a bound is not known the better for it.
class Profile {
 public:
  Profile(const TrajectoryFit& problem, const FitResult& fit)
      : problem_{problem},
        fit_{fit},
        map_{fit.model},
        best_{map_.pack(fit.model)},
        windows_{problem.linearise(fit, false)} {
    normal_ = normal_at(best_);
  }

  [[nodiscard]] const ParameterMap& map() const { return map_; }
  [[nodiscard]] double best(Eigen::Index i) const { return best_[i]; }
  /// Scaled variance were every row independent of all others.
  [[nodiscard]] double plain_variance(Eigen::Index i) const {
    return normal_.H.ldlt().solve(Eigen::VectorXd::Unit(best_.size(), i))[i];
  }
  /// The least cost with number `i` at `value` (scaled), settled to a share of `significant`. Nothing where the others
  /// do not settle: then no parabola is near, or the fit itself has not come to rest.
  [[nodiscard]] std::optional<double> cost_at(Eigen::Index i, double value, double significant) const {
    const std::vector<Eigen::Index> others = all_but(i);
    Eigen::VectorXd x = best_;
    x[i] = value;
    const Eigen::VectorXd along = normal_.H(others, i);
    x(others) -= (value - best_[i]) * normal_.H(others, others).ldlt().solve(along);
    Normal now = normal_at(x);
    if (!std::isfinite(now.cost)) return std::numeric_limits<double>::infinity();
    for (int step = 0; step < kSteps; ++step) {
      const Eigen::VectorXd g = now.g(others);
      const Eigen::VectorXd move = -now.H(others, others).ldlt().solve(g);
      const double gain = -0.5 * g.dot(move);
      if (gain < kSettled * significant) return now.cost - gain;
      x(others) += move;
      Normal next = normal_at(x);
      if (!(next.cost < now.cost)) return std::nullopt;
      now = std::move(next);
    }
    return std::nullopt;
  }

 private:
  struct Normal {
    Eigen::MatrixXd H;
    Eigen::VectorXd g;
    double cost{};
  };

  [[nodiscard]] std::vector<Eigen::Index> all_but(Eigen::Index i) const {
    std::vector<Eigen::Index> others;
    for (Eigen::Index k = 0; k < best_.size(); ++k) {
      if (k != i) others.push_back(k);
    }
    return others;
  }

  /// With the weights of the fit's own outliers, so that costs can be compared.
  [[nodiscard]] Normal normal_at(const Eigen::VectorXd& x) const {
    FitResult at;
    at.model = fit_.model;
    map_.unpack(x, at.model);
    at.sigma = fit_.sigma;
    at.nu0 = fit_.nu0;
    const ParameterMap own{at.model};  // its scales follow the model
    const Eigen::Index n = x.size();
    Eigen::VectorXd ratio(n);
    Normal normal{Eigen::MatrixXd::Zero(n, n), Eigen::VectorXd::Zero(n), 0.0};
    for (Eigen::Index i = 0; i < n; ++i) {
      const FreeParameter& free = map_[static_cast<std::size_t>(i)];
      ratio[i] = free.scale / own[static_cast<std::size_t>(i)].scale;
      const double slope = free.scale / free.prior_sigma;
      const double away = (x[i] * free.scale - free.prior_mean) / free.prior_sigma;
      normal.H(i, i) = slope * slope;
      normal.g[i] = slope * away;
      normal.cost += 0.5 * away * away;
    }
    for (const ProjectedWindow& window : problem_.linearise(at, false, windows_)) {
      const Eigen::MatrixXd jacobian = window.jacobian * ratio.asDiagonal();
      normal.H.noalias() += jacobian.transpose() * jacobian;
      normal.g.noalias() += jacobian.transpose() * window.residual;
      normal.cost += 0.5 * window.residual.squaredNorm();
    }
    return normal;
  }

  const TrajectoryFit& problem_;
  const FitResult& fit_;
  ParameterMap map_;
  Eigen::VectorXd best_;
  std::vector<ProjectedWindow> windows_;
  Normal normal_;
};

/// Where number `i` ends on one side (`sign` -1 or 1), scaled: where the cost has risen by `significant` over `least`.
/// `half` is where a parabola would end, and the answer where nothing better is known.
double end_of(const Profile& profile, Eigen::Index i, double sign, double half, double least, double significant) {
  const FreeParameter& free = profile.map()[static_cast<std::size_t>(i)];
  const double from = profile.best(i), bound = (sign < 0.0 ? free.low : free.high) / free.scale;
  const double farthest = std::min(kFarthest * half, std::abs(bound - from));
  double inside = 0.0, outside = std::numeric_limits<double>::infinity();
  double reach = std::min(half, farthest);
  for (int probe = 0; probe < kProbes; ++probe) {
    const std::optional<double> cost = profile.cost_at(i, from + sign * reach, significant);
    if (!cost) return from + sign * std::min(std::max(half, inside), farthest);
    const double share = (*cost - least) / significant;
    if (share <= 1.0 && reach >= farthest) return from + sign * farthest;
    (share < 1.0 ? inside : outside) = reach;
    const double next =
        reach / std::sqrt(std::clamp(share, 1.0 / (kLongestStride * kLongestStride), kLongestStride * kLongestStride));
    if (std::abs(share - 1.0) < kNear) return from + sign * std::min(next, farthest);
    const bool between = next > inside && next < outside;
    reach = std::min(between ? next : 0.5 * (inside + outside), farthest);
  }
  return from + sign * reach;
}

}  // namespace

void add_profiles(const TrajectoryFit& problem, FitResult& fit) {
  if (fit.model.effects.empty()) return;
  const Profile profile{problem, fit};
  const ParameterMap& map = profile.map();
  const double t = fit.t95();
  fit.interval95.assign(map.size(), std::nullopt);
  for (std::size_t k = 0; k < map.size(); ++k) {
    const FreeParameter& free = map[k];
    const auto i = static_cast<Eigen::Index>(k);
    if (free.effect < 0 || !free.sought || free.at_bound(profile.best(i))) continue;
    if (free.component < fit.model.effects[static_cast<std::size_t>(free.effect)].effect->amplitudes()) continue;
    const double variance = fit.covariance(i, i) / (free.scale * free.scale), plain = profile.plain_variance(i);
    if (!(variance > 0.0) || !(plain > 0.0)) continue;
    const double significant = 0.5 * t * t * variance / plain;
    const std::optional<double> least = profile.cost_at(i, profile.best(i), significant);
    if (!least || !std::isfinite(*least)) continue;
    const double half = t * std::sqrt(variance);
    fit.interval95[k] = {free.scale * end_of(profile, i, -1.0, half, *least, significant),
                         free.scale * end_of(profile, i, 1.0, half, *least, significant)};
  }
}

}  // namespace fathom::identification
