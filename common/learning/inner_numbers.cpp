#include "common/learning/inner_numbers.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <numeric>
#include <vector>

#include "common/base/factors.hpp"
#include "common/inference/feature_screen.hpp"
#include "common/learning/within_factor.hpp"
#include "common/model/learned/learned_force.hpp"

namespace fathom::learning {
namespace {

using likelihood::Factor;
using likelihood::Feature;
using likelihood::Quantity;

constexpr int kSteps = 5;
constexpr double kSettled = 0.02;      // rad over half of the recordings, or of the room
constexpr double kMostTurned = 0.8;    // rad of a step over those: farther lies another line
constexpr double kSmallestRoom = 0.1;  // m to both sides: within less no phase goes with the place
constexpr double kOneWave = 5.0;       // nats that two swings must be worth more than one: a frequency has its price

bool is_cosine(Quantity quantity) { return quantity == Quantity::kToneCosine || quantity == Quantity::kTravelCosine; }
bool travels(Quantity quantity) { return quantity == Quantity::kTravelCosine || quantity == Quantity::kTravelSine; }

template <typename Of>
auto swing_of(Of& feature) -> decltype(feature.factors.data()) {
  for (int i = 0; i < feature.count; ++i) {
    auto& factor = feature.factors[static_cast<std::size_t>(i)];
    if (travels(factor.quantity) || is_cosine(factor.quantity) || factor.quantity == Quantity::kToneSine)
      return &factor;
  }
  return nullptr;
}

Quantity turned(Quantity quantity) {
  switch (quantity) {
    case Quantity::kToneCosine:
      return Quantity::kToneSine;
    case Quantity::kToneSine:
      return Quantity::kToneCosine;
    case Quantity::kTravelCosine:
      return Quantity::kTravelSine;
    default:
      return Quantity::kTravelCosine;
  }
}

/// The same wave, by frequency and wave numbers, or the same point and length.
bool same(const Factor& one, const Factor& other) {
  if (has_inner(one) || has_inner(other)) return one == other;
  return travels(one.quantity) == travels(other.quantity) && one.a == other.a &&
         (!travels(one.quantity) || (one.b == other.b && one.c == other.c));
}

/// The factor of a feature that has inner numbers, if one has.
template <typename Of>
auto tunable_in(Of& feature) -> decltype(feature.factors.data()) {
  const auto factor = factor_with_inner(feature);
  return factor != nullptr ? factor : swing_of(feature);
}

/// An inner number, and what the force does by it as columns of features. Of a wave exp(-|k| z) cos(omega t - k p): by
/// omega -t sin(..), by k +p sin(..) - z k / |k| cos(..). Time, place and depth about their middles: the rest is a
/// change of the weights. Of a point, a length, a bearing, a reach: differences.
struct Inner {
  Factor factor;
  std::size_t which{};  ///< as number_of() counts: of a wave 0 frequency, 1 and 2 wave numbers toward north and east
  double unit{1.0};     ///< of its steps
  double sigma{};       ///< how far it may be from where it is; 0: nothing is known
};
struct Slopes {
  std::vector<Inner> inner;
  likelihood::FreeForce columns;
  std::vector<std::size_t> of;  ///< which inner number a column belongs to
  std::vector<double> share;    ///< of a column in the derivative
};

std::size_t place_of(Slopes& slopes, const Inner& inner) {
  const auto found = std::ranges::find_if(
      slopes.inner, [&](const Inner& other) { return other.which == inner.which && same(other.factor, inner.factor); });
  if (found != slopes.inner.end()) return static_cast<std::size_t>(found - slopes.inner.begin());
  slopes.inner.push_back(inner);
  return slopes.inner.size() - 1;
}

void add_column(Slopes& slopes, std::size_t place, Feature feature, double share) {
  slopes.of.push_back(place);
  slopes.share.push_back(share);
  slopes.columns.groups.push_back(
      {.axis = feature.axis, .first = static_cast<int>(slopes.columns.features.size()), .count = 1});
  slopes.columns.features.push_back(std::move(feature));
}

/// Of laws: a table keeps its places.
void slopes_within_factors(const likelihood::FreeForce& force, const Room& room, Slopes& slopes) {
  for (const likelihood::FeatureGroup& group : force.groups) {
    for (int k = group.first; k < group.first + group.count && group.closed; ++k) {
      const auto j = static_cast<std::size_t>(k);
      const Feature& feature = force.features[j];
      const Factor* factor = factor_with_inner(feature);
      if (factor == nullptr) continue;
      for (const WithinFactor& inner : inner_of(*factor, room)) {
        const std::size_t place = place_of(slopes, {*factor, inner.which, inner.step, inner.sigma});
        const Beside other = beside(feature, inner, room);
        add_column(slopes, place, other.feature, force.weights[j] / other.off);
        add_column(slopes, place, feature, -force.weights[j] / other.off);
      }
    }
  }
}

Slopes slopes_of(const likelihood::FreeForce& force, const Room& room) {
  Slopes slopes;
  slopes_within_factors(force, room, slopes);
  for (std::size_t j = 0; j < force.features.size(); ++j) {
    const Factor* swing = swing_of(force.features[j]);
    if (swing == nullptr || force.features[j].count == static_cast<int>(force.features[j].factors.size())) continue;
    for (std::size_t i = 0; i < (travels(swing->quantity) ? 3U : 1U); ++i) {
      if (i > 0 && room.half[i] < kSmallestRoom) continue;
      const std::size_t place = place_of(slopes, {*swing, i, 1.0 / room.half[i]});
      const auto add = [&](bool turn, std::size_t by, double share) {
        Feature feature = force.features[j];
        Factor* own = swing_of(feature);
        if (turn) own->quantity = turned(own->quantity);
        feature.factors[static_cast<std::size_t>(feature.count++)] = room.factor(by);
        add_column(slopes, place, std::move(feature), share * room.half[by] * force.weights[j]);
      };
      add(true, i, is_cosine(swing->quantity) == (i == 0) ? -1.0 : 1.0);
      const double wave_number = std::hypot(swing->b, swing->c);
      if (i > 0 && wave_number > 0.0 && room.half[3] > 0.0)
        add(false, 3, -(i == 1 ? swing->b : swing->c) / wave_number);
    }
  }
  return slopes;
}

likelihood::Fit fitted(const likelihood::Problem& problem, const likelihood::Hypothesis& hypothesis,
                       const likelihood::Noise& noise, int threads) {
  return likelihood::fit(problem, hypothesis, noise,
                         {.noise_rounds = 1, .steps = 2, .enough = 0.3, .fit_noise = false, .threads = threads});
}

/// Gauss-Newton on the inner numbers, the others projected out.
likelihood::Fit tuned(const likelihood::Problem& problem, likelihood::Fit fit, const Room& room, int threads) {
  for (int step = 0; step < kSteps; ++step) {
    const Slopes slopes = slopes_of(fit.hypothesis.force, room);
    if (slopes.inner.empty()) break;
    const inference::Seen seen = inference::see(problem, fit, threads);
    std::vector<std::size_t> groups(slopes.of.size());
    std::iota(groups.begin(), groups.end(), std::size_t{0});
    const inference::Screen screen = inference::screen(problem, seen, slopes.columns, groups, true);
    Eigen::MatrixXd shares = Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(slopes.of.size()),
                                                   static_cast<Eigen::Index>(slopes.inner.size()));
    for (std::size_t k = 0; k < slopes.of.size(); ++k)
      shares(static_cast<Eigen::Index>(k), static_cast<Eigen::Index>(slopes.of[k])) = slopes.share[k];
    Eigen::MatrixXd information = shares.transpose() * screen.gram * shares;
    if (!(information.diagonal().minCoeff() > 0.0)) break;
    information.diagonal() *= 1.0 + 1e-9;
    for (std::size_t k = 0; k < slopes.inner.size(); ++k) {
      const auto at = static_cast<Eigen::Index>(k);
      if (slopes.inner[k].sigma > 0.0) information(at, at) += 1.0 / (slopes.inner[k].sigma * slopes.inner[k].sigma);
    }
    const Eigen::VectorXd change = solve_symmetric(information, Eigen::VectorXd{shares.transpose() * screen.gradient});
    if (!change.allFinite()) break;
    likelihood::Hypothesis moved = fit.hypothesis;
    double most = 0.0;
    for (std::size_t k = 0; k < slopes.inner.size(); ++k) {
      const Inner& inner = slopes.inner[k];
      const double turn = change[static_cast<Eigen::Index>(k)] / inner.unit;
      most = std::max(most, std::abs(turn));
      for (std::size_t j = 0; j < moved.force.features.size(); ++j) {
        const Factor* before = tunable_in(fit.hypothesis.force.features[j]);
        if (before == nullptr || !same(*before, inner.factor)) continue;
        Factor& factor = *tunable_in(moved.force.features[j]);
        number_of(factor, inner.which) += inner.unit * std::clamp(turn, -kMostTurned, kMostTurned);
      }
    }
    for (Feature& feature : moved.force.features) {
      if (Factor* factor = factor_with_inner(feature)) settle(*factor, room);
    }
    if (most < kSettled) break;
    likelihood::Fit again = fitted(problem, moved, fit.noise, threads);
    if (!again.finite || again.log_evidence <= fit.log_evidence) break;
    fit = std::move(again);
  }
  return fit;
}

/// Swings that lie within half a turn of each other over the recordings take the numbers of the strongest of them.
likelihood::FreeForce joined(const likelihood::FreeForce& force, const Room& room, bool& any) {
  struct Wave {
    Factor factor;
    double square{};  ///< of its weights
  };
  std::vector<Wave> waves;
  for (std::size_t j = 0; j < force.features.size(); ++j) {
    const Factor* swing = swing_of(force.features[j]);
    if (swing == nullptr) continue;
    auto found = std::ranges::find_if(waves, [&](const Wave& wave) { return same(wave.factor, *swing); });
    if (found == waves.end()) found = waves.insert(found, {*swing});
    found->square += force.weights[j] * force.weights[j];
  }
  std::ranges::stable_sort(waves, std::greater{}, &Wave::square);
  likelihood::FreeForce one = force;
  any = false;
  for (Feature& feature : one.features) {
    Factor* swing = swing_of(feature);
    if (swing == nullptr) continue;
    const auto strongest = std::ranges::find_if(waves, [&](const Wave& wave) {
      return travels(wave.factor.quantity) == travels(swing->quantity) &&
             std::abs(wave.factor.a - swing->a) * 2.0 * room.half[0] < std::numbers::pi;
    });
    if (same(strongest->factor, *swing)) continue;
    any = true;
    for (std::size_t i = 0; i < 3; ++i) number_of(*swing, i) = number_of(strongest->factor, i);
  }
  return one;
}

}  // namespace

likelihood::Fit with_inner_numbers(const likelihood::Problem& problem, likelihood::Fit fit, int threads) {
  if (!fit.finite || (!model::swings(fit.hypothesis.force) &&
                      std::ranges::none_of(fit.hypothesis.force.features, [](const Feature& feature) {
                        return factor_with_inner(feature) != nullptr;
                      })))
    return fit;
  const Room room{problem};
  bool any = false;
  likelihood::Hypothesis one = fit.hypothesis;
  one.force = joined(fit.hypothesis.force, room, any);
  if (any) {
    likelihood::Fit together = fitted(problem, one, fit.noise, threads);
    if (together.finite) together = tuned(problem, std::move(together), room, threads);
    if (together.finite && together.log_evidence > fit.log_evidence - kOneWave) return together;
  }
  return tuned(problem, std::move(fit), room, threads);
}

}  // namespace fathom::learning
