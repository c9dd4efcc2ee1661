#include "common/learning/seek_force.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "common/base/factors.hpp"
#include "common/base/parallel.hpp"
#include "common/inference/feature_screen.hpp"
#include "common/learning/moments.hpp"
#include "common/learning/products.hpp"
#include "common/model/learned/learned_force.hpp"

namespace fathom::learning {
namespace {

using inference::ColumnRange;
using inference::FreeForceFound;
using inference::GroupEvidence;
using inference::Seen;

constexpr std::size_t kShortlist = 24;  // groups whose products with all others are worked out
constexpr std::size_t kProfiled = 4;    // of those that begin at a moment: its place is sought more closely
constexpr double kFactor = 4.0;         // by which the second start's random force is smaller
constexpr double kSettled = 4.0;        // times the odds that are needed: no second start could change the verdict

/// What a screen has taken up.
struct Picked {
  likelihood::FreeForce force;
  double log_odds{};  ///< nats of all together, prices paid
};

likelihood::FreeForce both(likelihood::FreeForce force, const likelihood::FreeForce& more) {
  for (likelihood::FeatureGroup group : more.groups) {
    group.first += static_cast<int>(force.features.size());
    force.groups.push_back(std::move(group));
  }
  force.features.insert(force.features.end(), more.features.begin(), more.features.end());
  force.weights.insert(force.weights.end(), more.weights.begin(), more.weights.end());
  return force;
}

class Seeker {
 public:
  Seeker(const likelihood::Problem& problem, const likelihood::Fit& base, const model::Scene& scene,
         const Limits& limits, int threads)
      : problem_{problem}, scene_{scene}, limits_{limits}, threads_{threads}, seen_{seen(base)} {}

  Sought run() {
    Sought sought;
    FreeForceFound& found = sought.all;
    double evidence = seen_.fit.log_evidence;  // prices paid
    for (int round = 0; round < limits_.rounds; ++round) {
      // A table over time explains anything: what lasts has the first go, and explains what it can.
      const bool of_recording = round > 0, first = !found.fit.finite;
      std::optional<Seen> again;
      if (!first) again = seen(found.fit);
      const Seen& now = again ? *again : seen_;
      const Picked picked = pick(now, first, of_recording);
      if (picked.force.empty()) {
        if (of_recording) break;
        continue;
      }
      if (first) found.at_fixed_noise = picked.log_odds;
      // What the random force has swallowed shows where it is smaller.
      std::optional<Picked> quiet;
      if (first && swallows(now)) {
        likelihood::Fit quick = now.fit;
        quick.noise = quickened(now);
        quiet = pick(seen(std::move(quick)), true, of_recording);
      }
      const bool settled = !first || found.at_fixed_noise >= kSettled * thresholds_.free_force_odds;
      std::vector<likelihood::Fit> fits(quiet || !settled ? 2 : 1);
      for_each_index(fits.size(), threads_, [&](std::size_t start) {
        likelihood::Noise noise = now.fit.noise;
        if (start > 0 && quiet) {
          noise = quickened(now);
        } else if (start > 0) {
          for (likelihood::AxisNoise& axis : noise) axis.log[likelihood::kForce] -= std::log(kFactor);
        }
        fits[start] = fitted(now.fit.hypothesis, start > 0 && quiet ? quiet->force : picked.force, noise,
                             fits.size() == 1 ? threads_ : 1);
      });
      const likelihood::Fit* best = nullptr;
      for (const likelihood::Fit& fit : fits) {
        if (fit.finite && (best == nullptr || worth(fit) > worth(*best))) best = &fit;
      }
      // What the screen promises and no fit keeps is not found.
      const double gained = best == nullptr ? 0.0 : worth(*best) - evidence;
      if (gained < thresholds_.group_gain) {
        if (of_recording) break;
        continue;
      }
      found.fit = *best;
      evidence = worth(*best);
      if (!of_recording) sought.lasting = found;
    }
    for (FreeForceFound* each : {&sought.all, &sought.lasting}) {
      if (!each->fit.finite) continue;
      prune(each->fit);
      conclude(*each);
    }
    return sought;
  }

 private:
  [[nodiscard]] Seen seen(likelihood::Fit fit) const {
    Seen seen = inference::see(problem_, std::move(fit), threads_);
    inference::take_step(seen);
    return seen;
  }

  /// Groups that are worth more than they cost, one after the other, those that have become superfluous taken back.
  [[nodiscard]] Picked pick(const Seen& seen, bool at_least_one, bool of_recording) {
    likelihood::FreeForce library = products_of(problem_, seen, scene_, of_recording);
    const std::size_t all = library.groups.size();
    groups_ = std::max(groups_, all);
    std::vector<double> alone(all);
    const std::vector<std::vector<std::size_t>> batches = inference::batches_of(library);
    for_each_index(batches.size(), threads_, [&](std::size_t b) {
      const inference::Screen several = inference::screen(problem_, seen, library, batches[b], false);
      for (std::size_t k = 0; k < batches[b].size(); ++k) {
        const std::size_t g = batches[b][k];
        alone[g] = inference::group_evidence(several.gram, several.gradient, std::span{several.ranges}.subspan(k, 1),
                                             {inference::kStartSigma})
                       .log_bayes_factor -
                   price(library.groups[g], all);
      }
    });
    std::vector<std::size_t> shortlist;
    for (std::size_t g = 0; g < all; ++g) {
      if (!held(seen, library, library.groups[g])) shortlist.push_back(g);
    }
    if (shortlist.empty()) return {};
    const auto best_first = [&] {
      std::ranges::stable_sort(shortlist, std::greater{}, [&](std::size_t g) { return alone[g]; });
    };
    best_first();
    std::vector<std::size_t> begun;
    for (const std::size_t g : shortlist) {
      if (begun.size() == kProfiled) break;
      if (library.groups[g].searched) begun.push_back(g);
    }
    for (const auto& [g, evidence] : profile_moments(problem_, seen, begun, library, threads_))
      alone[g] = evidence - price(library.groups[g], all);
    best_first();
    shortlist.resize(std::min(shortlist.size(), kShortlist));
    const inference::Screen whole = inference::screen(problem_, seen, library, shortlist, true);
    const auto price_of = [&](std::size_t k) { return price(library.groups[whole.groups[k]], all); };
    const auto evidence_of = [&](const std::vector<std::size_t>& of, std::vector<double> sigma) {
      std::vector<ColumnRange> ranges;
      for (const std::size_t k : of) ranges.push_back(whole.ranges[k]);
      return inference::group_evidence(whole.gram, whole.gradient, ranges, std::move(sigma));
    };
    std::vector<std::size_t> picked;
    GroupEvidence evidence;
    double priced = 0.0;
    const auto most = static_cast<std::size_t>(
        std::max(0, limits_.most_groups - static_cast<int>(seen.fit.hypothesis.force.groups.size())));
    while (picked.size() < most) {
      double best = thresholds_.group_gain;
      std::size_t taken = shortlist.size();
      GroupEvidence of_best;
      for (std::size_t k = 0; k < shortlist.size(); ++k) {
        if (std::ranges::find(picked, k) != picked.end()) continue;
        std::vector<std::size_t> of = picked;
        of.push_back(k);
        std::vector<double> sigma = evidence.sigma;
        sigma.push_back(inference::kStartSigma);
        GroupEvidence with = evidence_of(of, std::move(sigma));
        const double gain = with.log_bayes_factor - evidence.log_bayes_factor - price_of(k);
        if (gain <= best) continue;
        best = gain;
        taken = k;
        of_best = std::move(with);
      }
      if (taken == shortlist.size()) break;
      picked.push_back(taken);
      priced += price_of(taken);
      evidence = std::move(of_best);
      for (std::size_t k = 0; k + 1 < picked.size();) {  // the one that was just taken up stays
        std::vector<std::size_t> of = picked;
        std::vector<double> sigma = evidence.sigma;
        of.erase(of.begin() + static_cast<std::ptrdiff_t>(k));
        sigma.erase(sigma.begin() + static_cast<std::ptrdiff_t>(k));
        GroupEvidence without = evidence_of(of, std::move(sigma));
        if (without.log_bayes_factor + price_of(picked[k]) <= evidence.log_bayes_factor) {
          ++k;
          continue;
        }
        priced -= price_of(picked[k]);
        picked = std::move(of);
        evidence = std::move(without);
      }
    }
    // Where nothing stands out, the best is fitted all the same: the fitted random force may have swallowed it.
    if (picked.empty() && at_least_one && most > 0) {
      picked.push_back(0);
      priced = price_of(0);
      evidence = evidence_of(picked, {inference::kStartSigma});
    }
    if (picked.empty()) return {};
    return {inference::chosen(library, whole, picked, evidence), evidence.log_bayes_factor - priced};
  }

  /// A group of the force that is in the model already.
  static bool held(const Seen& seen, const likelihood::FreeForce& library, const likelihood::FeatureGroup& group) {
    const auto features = [](const likelihood::FreeForce& force, const likelihood::FeatureGroup& of) {
      return std::span{force.features}.subspan(static_cast<std::size_t>(of.first), static_cast<std::size_t>(of.count));
    };
    const likelihood::FreeForce& force = seen.fit.hypothesis.force;
    return !group.searched && std::ranges::any_of(force.groups, [&](const likelihood::FeatureGroup& other) {
      return std::ranges::equal(features(force, other), features(library, group), [](const auto& a, const auto& b) {
        return a.axis == b.axis && a.count == b.count && a.factors == b.factors;
      });
    });
  }

  /// A random force of practical size that remembers for long may have taken something slow for its own.
  [[nodiscard]] bool swallows(const Seen& seen, std::size_t i) const {
    const likelihood::AxisNoise& noise = seen.fit.noise[i];
    return noise[likelihood::kForce] > thresholds_.smallest_size * seen.applied[problem_.axes[i]] &&
           noise[likelihood::kForceMemory] > thresholds_.swallowing_memory;
  }
  [[nodiscard]] bool swallows(const Seen& seen) const {
    for (std::size_t i = 0; i < static_cast<std::size_t>(problem_.simulated); ++i) {
      if (swallows(seen, i)) return true;
    }
    return false;
  }

  /// The noise without what is slow in such random forces: as quick as they are at first, sigma^2 / tau stays what it
  /// is.
  [[nodiscard]] likelihood::Noise quickened(const Seen& seen) const {
    likelihood::Noise noise = seen.fit.noise;
    const likelihood::Noise usual = likelihood::prior_noise(problem_);
    for (std::size_t i = 0; i < static_cast<std::size_t>(problem_.simulated); ++i) {
      if (!swallows(seen, i)) continue;
      const double shorter = usual[i].log[likelihood::kForceMemory] - noise[i].log[likelihood::kForceMemory];
      noise[i].log[likelihood::kForceMemory] += shorter;
      noise[i].log[likelihood::kForce] += 0.5 * shorter;
    }
    return noise;
  }

  [[nodiscard]] likelihood::Fit fitted(const likelihood::Hypothesis& from, const likelihood::FreeForce& more,
                                       const likelihood::Noise& noise, int threads) const {
    likelihood::FitOptions options{.noise_rounds = 2, .steps = 2, .enough = 0.3, .threads = threads};
    // The screen is linear: where its weights run away in the filter, the fit begins from smaller ones.
    likelihood::Fit fit;
    for (const double share : {1.0, 0.3, 0.0}) {
      likelihood::FreeForce smaller = more;
      for (double& weight : smaller.weights) weight *= share;
      likelihood::Hypothesis hypothesis = from;
      hypothesis.force = both(hypothesis.force, smaller);
      fit = likelihood::fit(problem_, hypothesis, noise, options);
      if (fit.finite) break;
    }
    if (!fit.finite) return fit;
    inference::renew_sigmas(fit);
    options.noise_rounds = kMostRounds;
    likelihood::Fit again = likelihood::fit(problem_, fit.hypothesis, fit.noise, options);
    return again.finite ? again : fit;
  }

  [[nodiscard]] double price_of(const likelihood::FreeForce& force) const {
    double sum = 0.0;
    for (const likelihood::FeatureGroup& group : force.groups) sum += price(group, groups_);
    return sum;
  }
  [[nodiscard]] double worth(const likelihood::Fit& fit) const {
    return fit.log_evidence - price_of(fit.hypothesis.force);
  }

  /// Nats that each group is worth, its price paid: Savage and Dickey's ratio of densities at no weight.
  [[nodiscard]] std::vector<double> worths(const likelihood::Fit& fit) const {
    const Eigen::Index p = fit.information.rows();
    const Eigen::MatrixXd covariance = inverse_symmetric(fit.information);
    Eigen::Index first = 0;
    while (first < p && fit.numbers[static_cast<std::size_t>(first)].kind != likelihood::NumberKind::kWeight) ++first;
    std::vector<double> worths;
    for (const likelihood::FeatureGroup& group : fit.hypothesis.force.groups) {
      const Eigen::MatrixXd C = covariance.block(first + group.first, first + group.first, group.count, group.count);
      const Eigen::Map<const Eigen::VectorXd> w{fit.hypothesis.force.weights.data() + group.first, group.count};
      const SymmetricFactor factor{C};
      const double log_det = factor.pivots().array().max(1e-300).log().sum();
      worths.push_back(0.5 * w.dot(factor.solve(w)) + 0.5 * log_det - group.count * std::log(group.sigma) -
                       price(group, groups_));
    }
    return worths;
  }

  /// Groups that others have made superfluous go, if a fit without them agrees.
  void prune(likelihood::Fit& fit) const {
    const std::vector<double> worth_of = worths(fit);
    const likelihood::FreeForce& force = fit.hypothesis.force;
    const likelihood::FreeForce kept =
        model::kept_of(force, [&](const likelihood::FeatureGroup& group, const likelihood::Feature&) {
          return worth_of[static_cast<std::size_t>(&group - force.groups.data())] > 0.0;
        });
    if (kept.empty() || kept.groups.size() == worth_of.size()) return;
    likelihood::Hypothesis hypothesis = fit.hypothesis;
    hypothesis.force = {};
    likelihood::Fit without = fitted(hypothesis, kept, fit.noise, threads_);
    if (without.finite && worth(without) >= worth(fit)) fit = std::move(without);
  }

  void conclude(FreeForceFound& found) const {
    const likelihood::FreeForce& force = found.fit.hypothesis.force;
    found.log_odds = worth(found.fit) - seen_.fit.log_evidence;
    const std::vector<double> worth_of = worths(found.fit);
    for (std::size_t g = 0; g < worth_of.size(); ++g)
      found.groups.push_back({force.groups[g].kind, force.groups[g].axis, worth_of[g]});
    std::ranges::stable_sort(found.groups, std::greater{}, &inference::GroupFound::gain);
    for (std::size_t i = 0; i < static_cast<std::size_t>(problem_.simulated); ++i) {
      const double left = found.fit.noise[i][likelihood::kForce] / seen_.fit.noise[i][likelihood::kForce];
      found.explainable.push_back(std::max(0.0, 1.0 - left * left));
    }
    found.size = inference::size_of_force(problem_, seen_, force);
  }

  [[nodiscard]] double price(const likelihood::FeatureGroup& group, std::size_t of) const {
    return inference::price(group, of, thresholds_);
  }

  static constexpr int kMostRounds = 4;
  const likelihood::Problem& problem_;
  const model::Scene& scene_;
  const inference::Thresholds thresholds_{};
  const Limits& limits_;
  int threads_;
  Seen seen_;
  std::size_t groups_{1};  // that were screened
};

}  // namespace

Sought seek_force(const likelihood::Problem& problem, const likelihood::Fit& base, const model::Scene& scene,
                  const Limits& limits, int threads) {
  return Seeker{problem, base, scene, limits, threads}.run();
}

}  // namespace fathom::learning
