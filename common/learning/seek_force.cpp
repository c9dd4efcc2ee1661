#include "common/learning/seek_force.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "common/base/factors.hpp"
#include "common/base/parallel.hpp"
#include "common/inference/feature_screen.hpp"
#include "common/learning/inner_numbers.hpp"
#include "common/learning/pick_groups.hpp"
#include "common/learning/steps.hpp"
#include "common/model/learned/learned_force.hpp"

namespace fathom::learning {
namespace {

using inference::FreeForceFound;
using inference::Seen;

constexpr double kFactor = 4.0;   // by which the second start's random force is smaller
constexpr double kSettled = 4.0;  // times the odds that are needed: no second start could change the verdict

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

  Sought run(const Progress& progress) {
    Sought sought;
    FreeForceFound& found = sought.all;
    double evidence = seen_.fit.log_evidence;  // prices paid
    bool begun_again = false;
    for (int round = 0; round < limits_.rounds; ++round) {
      if (round > 0) progress.done(kSeek.phase);
      // A table over time explains anything, a swing much: what lasts has the first go, and explains what it can. Where
      // it has left no room, it may stand for something else: then all begin once more together.
      const Clock clock = round == 0 ? Clock::kLasting : round == 1 ? Clock::kSwings : Clock::kTables;
      const bool full = found.fit.finite && room_beside(found.fit) == 0;
      if (full && std::exchange(begun_again, true)) break;
      const bool first = !found.fit.finite || full;
      std::optional<Seen> again;
      if (!first) again = seen(found.fit);
      const Seen& now = again ? *again : seen_;
      const Picked picked = pick(now, first, clock);
      // What swings is imitated by places and depths that come again and again: where a swing is worth more than all of
      // them, what lasts does not go first.
      if (clock == Clock::kLasting) {
        const Picked swinging = pick(now, first, Clock::kSwings);
        if (swinging.log_odds > picked.log_odds + limits_.swings &&
            take(swinging, now, first, Clock::kSwings, found, evidence)) {
          double alone = seen_.fit.log_evidence;
          take(picked, now, first, clock, sought.lasting, alone);
          continue;
        }
      }
      if (take(picked, now, first, clock, found, evidence) && clock == Clock::kLasting) sought.lasting = found;
    }
    for (FreeForceFound* each : {&sought.all, &sought.lasting}) {
      if (!each->fit.finite) continue;
      prune(each->fit);
      conclude(*each);
    }
    return sought;
  }

  /// What was found on stretches of these runs, with the numbers that all of them give it.
  [[nodiscard]] Sought on_whole(const Seeker& ahead, const Sought& there) {
    groups_ = ahead.groups_;
    const auto with = [&](const FreeForceFound& found) {
      FreeForceFound whole{.at_fixed_noise = found.at_fixed_noise};
      if (!found.fit.finite) return whole;
      whole.fit = fitted(seen_.fit.hypothesis, found.fit.hypothesis.force, seen_.fit.noise, threads_);
      if (!whole.fit.finite) return whole;
      prune(whole.fit);
      conclude(whole);
      return whole;
    };
    const bool lasts = there.lasting.fit.finite && there.all.fit.finite &&
                       there.lasting.fit.hypothesis.force.groups.size() == there.all.fit.hypothesis.force.groups.size();
    Sought sought{.all = with(there.all)};
    sought.lasting = lasts ? sought.all : with(there.lasting);
    return sought;
  }

 private:
  [[nodiscard]] Seen seen(likelihood::Fit fit) const { return inference::see(problem_, std::move(fit), threads_); }

  [[nodiscard]] Picked pick(const Seen& seen, bool at_least_one, Clock clock) {
    Picked picked =
        pick_groups(problem_, seen, scene_,
                    {.most = room_beside(seen.fit), .clock = clock, .at_least_one = at_least_one, .threads = threads_});
    groups_ = std::max(groups_, picked.among);
    return picked;
  }

  [[nodiscard]] std::size_t room_beside(const likelihood::Fit& fit) const {
    return static_cast<std::size_t>(
        std::max(0, limits_.most_groups - static_cast<int>(fit.hypothesis.force.groups.size())));
  }

  /// Fits what was picked; true where the fit keeps what the screen promised, and then it is what was found.
  bool take(const Picked& picked, const Seen& now, bool first, Clock clock, FreeForceFound& found, double& evidence) {
    if (picked.force.empty()) return false;
    // What the random force has swallowed shows where it is smaller.
    std::optional<Picked> quiet;
    if (first && swallows(now)) {
      likelihood::Fit quick = now.fit;
      quick.noise = quickened(now);
      quiet = pick(seen(std::move(quick)), true, clock);
    }
    const bool settled = !first || picked.log_odds >= kSettled * thresholds_.free_force_odds;
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
    if (gained < thresholds_.group_gain) return false;
    if (first) found.at_fixed_noise = picked.log_odds;
    found.fit = with_inner_numbers(problem_, *best, threads_);
    evidence = worth(found.fit);
    return true;
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
                  const Limits& limits, int threads, const Progress& progress,
                  const std::optional<inference::Stretches>& stretches) {
  begin(progress, kSeek, limits.rounds + (stretches ? stretches->of_whole : 0.0));
  Sought sought;
  if (!stretches) {
    sought = Seeker{problem, base, scene, limits, threads}.run(progress);
  } else {
    const likelihood::Problem few = likelihood::make_problem(*problem.vehicle, stretches->trials, problem.run_settings);
    likelihood::Hypothesis there = base.hypothesis;
    there.runs.clear();
    for (const std::size_t run : stretches->run) there.runs.push_back(base.hypothesis.runs[run]);
    const likelihood::Fit again =
        likelihood::fit(few, there, base.noise, {.noise_rounds = 2, .steps = 2, .threads = threads});
    if (again.finite) {
      Seeker ahead{few, again, scene, limits, threads};
      sought = ahead.run(progress);
      if (sought.all.fit.finite) sought = Seeker{problem, base, scene, limits, threads}.on_whole(ahead, sought);
    }
  }
  progress.expect(kSeek.phase, 0);
  return sought;
}

}  // namespace fathom::learning
