#include "common/learning/pulls.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>

#include "common/base/factors.hpp"
#include "common/base/parallel.hpp"

namespace fathom::learning {
namespace {

using model::Factor;
using model::Feature;
using model::Quantity;

constexpr double kLeastReach = 0.5;  // m
constexpr int kBearings = 8;
constexpr int kSteps = 12;            // of the search of one point
constexpr double kDifference = 0.02;  // of the reach, between columns whose difference is a derivative
constexpr double kFarthest = 0.5;     // of the reach, in one step
constexpr double kGains = 0.1;        // nats: a step that gains less is the last
constexpr double kDamping = 1e-2, kMostDamping = 1e4, kSofter = 0.2, kHarder = 8.0;

class Profile {
 public:
  Profile(const likelihood::Problem& problem, const inference::Seen& seen, const model::Scene& scene)
      : problem_{problem},
        seen_{seen},
        reach_{reach_of(scene)},
        wrench_{std::max(scene.tau_rms.head<3>().norm(), 1e-6)} {}

  double best(Feature& feature) const {
    Look now = look(feature);
    double damping = kDamping;
    for (int step = 0; step < kSteps && damping < kMostDamping; ++step) {
      Feature moved = feature;
      const Eigen::Vector4d change = change_of(now, damping);
      Factor& stretch = *stretch_in(moved);
      for (std::size_t i = 0; i < kNumbersOfStretch; ++i) number_of(stretch, i) += change[static_cast<Eigen::Index>(i)];
      stretch.d = std::max(stretch.d, 0.0);
      const Look then = look(moved);
      const double gained = then.evidence - now.evidence;
      if (!(gained > 0.0)) {
        damping *= kHarder;
        continue;
      }
      feature = moved;
      now = then;
      damping *= kSofter;
      if (gained < kGains) break;
    }
    scale(feature);
    return now.evidence;
  }

 private:
  /// The pull, and what it does by N, E, D and length, as sums over the filter's innovations.
  struct Look {
    double evidence{};
    Eigen::Matrix<double, 5, 5> gram;
    Eigen::Matrix<double, 5, 1> gradient;
  };

  /// Root mean square of what it pulls becomes that of the applied wrench.
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

  [[nodiscard]] Look look(Feature feature) const {
    scale(feature);
    likelihood::FreeForce columns;
    const auto add = [&](const Feature& one) {
      columns.groups.push_back(
          {.axis = one.axis, .first = static_cast<int>(columns.features.size()), .count = 1, .searched = true});
      columns.features.push_back(one);
      columns.weights.push_back(0.0);
    };
    add(feature);
    for (std::size_t i = 0; i < kNumbersOfStretch; ++i) {
      Feature beside = feature;
      number_of(*stretch_in(beside), i) += kDifference * reach_;
      add(beside);
    }
    const inference::Screen screen = inference::screen(problem_, seen_, columns, {0, 1, 2, 3, 4}, true);
    Look look{.evidence = inference::group_evidence(screen.gram, screen.gradient, std::span{screen.ranges}.first(1),
                                                    {inference::kStartSigma})
                              .log_bayes_factor};
    Eigen::Matrix<double, 5, 5> difference = Eigen::Matrix<double, 5, 5>::Identity() / (kDifference * reach_);
    difference.row(0).setConstant(-1.0 / (kDifference * reach_));
    difference(0, 0) = 1.0;
    look.gram = difference.transpose() * screen.gram * difference;
    look.gradient = difference.transpose() * screen.gradient;
    if (!std::isfinite(look.evidence) || feature.scale == 0.0) look.evidence = -1e300;
    return look;
  }

  /// Gauss-Newton on weight and numbers together; no number is thought to be farther off than the reach.
  [[nodiscard]] Eigen::Vector4d change_of(const Look& look, double damping) const {
    if (!(look.gram(0, 0) > 0.0)) return Eigen::Vector4d::Zero();
    const double weight = look.gradient[0] / look.gram(0, 0);
    Eigen::Matrix<double, 5, 5> A = look.gram;
    A.diagonal().tail<4>() *= 1.0 + damping;
    A.diagonal().tail<4>().array() += 1.0 / std::max(std::pow(weight * reach_, 2), 1e-12);
    const Eigen::VectorXd x = solve_symmetric(Eigen::MatrixXd{A}, Eigen::VectorXd{look.gradient});
    Eigen::Vector4d change = x.tail<4>() / x[0];
    if (!change.allFinite()) return Eigen::Vector4d::Zero();
    const double length = change.norm(), most = kFarthest * reach_;
    return length > most ? Eigen::Vector4d{change * (most / length)} : change;
  }

  const likelihood::Problem& problem_;
  const inference::Seen& seen_;
  double reach_, wrench_;  // m, N
};

}  // namespace

double reach_of(const model::Scene& scene) { return std::max(0.5 * (scene.p_high - scene.p_low).norm(), kLeastReach); }

std::vector<Factor> stretches_of(const model::Scene& scene) {
  const Eigen::Vector3d middle = 0.5 * (scene.p_low + scene.p_high);
  const double reach = reach_of(scene);
  std::vector<Factor> all;
  const auto add = [&](const Eigen::Vector3d& off, double slack) {
    const Eigen::Vector3d point = middle + reach * off;
    all.push_back({.quantity = Quantity::kStretch, .a = point.x(), .b = point.y(), .c = point.z(), .d = reach * slack});
  };
  for (const double slack : {0.0, 0.4, 0.7}) add(Eigen::Vector3d::Zero(), slack);
  for (const double down : {-1.5, 1.5}) add({0.0, 0.0, down}, 1.0);
  for (int k = 0; k < kBearings; ++k) {
    const double bearing = 2.0 * std::numbers::pi * k / kBearings;
    const Eigen::Vector3d way{std::cos(bearing), std::sin(bearing), 0.0};
    add(0.5 * way, 0.7);
    add(1.2 * way, 0.0);
    add(1.2 * way, 1.2);
  }
  return all;
}

double& number_of(Factor& stretch, std::size_t i) {
  return i == 0 ? stretch.a : i == 1 ? stretch.b : i == 2 ? stretch.c : stretch.d;
}

std::vector<std::pair<std::size_t, double>> profile_pulls(const likelihood::Problem& problem,
                                                          const inference::Seen& seen, const model::Scene& scene,
                                                          const std::vector<std::size_t>& groups,
                                                          likelihood::FreeForce& library, int threads) {
  std::vector<std::pair<std::size_t, double>> found;
  for (const std::size_t g : groups) {
    if (stretch_in(library.features[static_cast<std::size_t>(library.groups[g].first)]) != nullptr)
      found.emplace_back(g, 0.0);
  }
  const Profile profile{problem, seen, scene};
  for_each_index(found.size(), threads, [&](std::size_t k) {
    auto& [g, evidence] = found[k];
    evidence = profile.best(library.features[static_cast<std::size_t>(library.groups[g].first)]);
  });
  return found;
}

}  // namespace fathom::learning
