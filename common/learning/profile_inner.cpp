#include "common/learning/profile_inner.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <span>

#include "common/base/factors.hpp"
#include "common/base/parallel.hpp"
#include "common/learning/within_factor.hpp"

namespace fathom::learning {
namespace {

using model::Factor;
using model::Feature;

constexpr int kSteps = 12;
constexpr double kMostSteps = 2.0;  // of an inner number, at once
constexpr double kGains = 0.1;      // nats: a step that gains less is the last
constexpr double kDamping = 1e-2, kMostDamping = 1e4, kSofter = 0.2, kHarder = 8.0;
constexpr double kNever = -1e300;

class Profile {
 public:
  Profile(const likelihood::Problem& problem, const inference::Seen& seen, const model::Scene& scene, const Room& room)
      : problem_{problem}, seen_{seen}, room_{room}, wrench_{std::max(scene.tau_rms.head<3>().norm(), 1e-6)} {}

  double best(std::span<Feature> features) const {
    std::vector<Feature> now{features.begin(), features.end()};
    Look look_now = look(now);
    double damping = kDamping;
    for (int step = 0; step < kSteps && damping < kMostDamping; ++step) {
      const std::vector<Feature> moved = by(now, change_of(look_now, damping));
      Look then = look(moved);
      const double gained = then.evidence - look_now.evidence;
      if (!(gained > 0.0)) {
        damping *= kHarder;
        continue;
      }
      now = moved;
      look_now = std::move(then);
      damping *= kSofter;
      if (gained < kGains) break;
    }
    std::ranges::copy(now, features.begin());
    return look_now.evidence;
  }

 private:
  /// Weights and inner numbers of a group together, as sums over the filter's innovations: the weights' columns are its
  /// features, an inner number's what they do by it, with the weights that are best without.
  struct Look {
    double evidence{kNever};
    std::vector<WithinFactor> inner;
    Eigen::MatrixXd gram;
    Eigen::VectorXd gradient;
  };

  [[nodiscard]] Look look(const std::vector<Feature>& features) const {
    Look look{.inner = inner_of(*factor_with_inner(features.front()), room_)};
    const auto n = static_cast<Eigen::Index>(features.size()), m = static_cast<Eigen::Index>(look.inner.size());
    likelihood::FreeForce columns;
    std::vector<double> off;
    const auto add = [&](const Feature& feature) {
      columns.groups.push_back({.axis = feature.axis, .first = static_cast<int>(columns.features.size()), .count = 1});
      columns.features.push_back(feature);
      columns.weights.push_back(0.0);
    };
    for (const Feature& feature : features) add(feature);
    for (const WithinFactor& inner : look.inner) {
      for (const Feature& feature : features) {
        const Beside one = beside(feature, inner, room_);
        add(one.feature);
        off.push_back(one.off);
      }
    }
    std::vector<std::size_t> all(columns.groups.size());
    std::iota(all.begin(), all.end(), std::size_t{0});
    const inference::Screen screen = inference::screen(problem_, seen_, columns, all, true);
    Eigen::MatrixXd own = screen.gram.topLeftCorner(n, n);
    if (!(own.diagonal().minCoeff() > 0.0)) return look;
    own.diagonal() *= 1.0 + 1e-6;
    const Eigen::VectorXd weight = solve_symmetric(own, Eigen::VectorXd{screen.gradient.head(n)});
    Eigen::MatrixXd shares = Eigen::MatrixXd::Zero(n + n * m, n + m);
    shares.topLeftCorner(n, n).setIdentity();
    for (Eigen::Index i = 0; i < m; ++i) {
      for (Eigen::Index k = 0; k < n; ++k) {
        const double share = weight[k] / off[static_cast<std::size_t>(i * n + k)];
        shares(n + i * n + k, n + i) = share;
        shares(k, n + i) = -share;
      }
    }
    look.gram = shares.transpose() * screen.gram * shares;
    look.gradient = shares.transpose() * screen.gradient;
    const inference::ColumnRange together{0, n};
    const double evidence =
        inference::group_evidence(screen.gram, screen.gradient, {&together, 1}, {inference::kStartSigma})
            .log_bayes_factor;
    if (std::isfinite(evidence)) look.evidence = evidence;
    return look;
  }

  [[nodiscard]] static Eigen::VectorXd change_of(const Look& look, double damping) {
    const auto m = static_cast<Eigen::Index>(look.inner.size()), n = look.gram.rows() - m;
    if (look.gram.rows() == 0) return Eigen::VectorXd::Zero(m);
    Eigen::MatrixXd A = look.gram;
    A.diagonal().head(n) *= 1.0 + 1e-6;
    A.diagonal().tail(m) *= 1.0 + damping;
    for (Eigen::Index i = 0; i < m; ++i) A(n + i, n + i) += std::pow(look.inner[static_cast<std::size_t>(i)].sigma, -2);
    Eigen::VectorXd change = solve_symmetric(A, look.gradient).tail(m);
    if (!change.allFinite()) return Eigen::VectorXd::Zero(m);
    double most = 1.0;  // the way is kept where one of them goes too far
    for (Eigen::Index i = 0; i < m; ++i)
      most = std::max(most, std::abs(change[i]) / (kMostSteps * look.inner[static_cast<std::size_t>(i)].step));
    return change / most;
  }

  [[nodiscard]] std::vector<Feature> by(std::vector<Feature> features, const Eigen::VectorXd& change) const {
    for (Feature& feature : features) {
      Factor& factor = *factor_with_inner(feature);
      const std::vector<WithinFactor> inner = inner_of(factor, room_);
      for (std::size_t i = 0; i < inner.size(); ++i)
        number_of(factor, inner[i].which) += change[static_cast<Eigen::Index>(i)];
      settle(factor, room_);
      if (feature.pulls()) scale(feature);
    }
    return features;
  }

  /// A line that was slack everywhere, or now is longer: root mean square of what it pulls is that of the wrench.
  void scale(Feature& feature) const {
    double square = 0.0, count = 0.0;
    feature.scale = 1.0;
    model::FeatureState state;
    for (const likelihood::RunData& run : problem_.runs) {
      for (const Eigen::Vector3d& p : run.trial().p_WB) {
        state.p_WB = p;
        square += std::pow(feature.value(state), 2);
        count += 1.0;
      }
    }
    feature.scale = square > 0.0 ? wrench_ / std::sqrt(square / count) : 0.0;
  }

  const likelihood::Problem& problem_;
  const inference::Seen& seen_;
  const Room& room_;
  double wrench_;  // N
};

}  // namespace

std::vector<std::pair<std::size_t, double>> profile_inner(const likelihood::Problem& problem,
                                                          const inference::Seen& seen, const model::Scene& scene,
                                                          const Room& room, const std::vector<std::size_t>& groups,
                                                          likelihood::FreeForce& library, int threads) {
  const Profile profile{problem, seen, scene, room};
  std::vector<std::pair<std::size_t, double>> found(groups.size());
  for_each_index(groups.size(), threads, [&](std::size_t k) {
    const likelihood::FeatureGroup& group = library.groups[groups[k]];
    found[k] = {groups[k], profile.best(std::span{library.features}.subspan(static_cast<std::size_t>(group.first),
                                                                            static_cast<std::size_t>(group.count)))};
  });
  return found;
}

}  // namespace fathom::learning
